// SPDX-License-Identifier: GPL-3.0-or-later
/// A sphere that hits a bed of beads in a cylinder at low velocity; see low_velocity_cratering.cpp.

#pragma once

#include "granular/validations/collision_record.hpp"
#include "granular/validations/validation.hpp"

#include <functional>
#include <vector>

namespace hilda::granular {

/// A cylinder with beads that settle under the gravity of the earth
struct BeadCylinder {
    double radius = 0.1575;  ///< [m]
    double depth = 0.16;     ///< approximate depth of the settled bed [m]
    double h = 1e-5;         ///< step [s]
};

/// What determines the settled beads
BedCase bed_case(const BeadCylinder& cylinder);

/// Centres of the settled beads, over a floor at z = 0 and about the axis x = y = 0, from
/// ValidationOptions::beds if they are kept there. `progress` receives values from 0 to 1. Throws
/// io::NumericalFailure if the bed does not settle.
std::vector<Vec3> settled_beads(
    const BeadCylinder& cylinder, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

struct SlowImpact {
    BeadCylinder cylinder = {};
    double height = 0.16;  ///< of the bed; beads above are removed before the impact [m]
    double mu_r = 0.09;    ///< coefficient of rolling friction of all contacts
    double speed = 1;      ///< of the sphere at its first contact [m/s]
    double g = 9.81;       ///< [m/s²]
    double x = 0;          ///< place of the impact, beside the axis of the cylinder [m]
    double h = 1e-5;       ///< step [s]
};

/// The record from 5 ms before the first contact to the stop of the sphere. The acceleration of a sample is
/// that of one step, and a sample is taken every 0.1 ms. `beads`: of settled_beads(). Throws
/// io::NumericalFailure if the sphere does not come to rest.
CollisionRecord impact(const SlowImpact& of, const std::vector<Vec3>& beads,
                       const ValidationOptions& options);

}  // namespace hilda::granular
