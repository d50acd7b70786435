// SPDX-License-Identifier: GPL-3.0-or-later
/// Mass properties of homogeneous solids, and of rigid bodies that consist of several.

#pragma once

#include "granular/core/boundary.hpp"

#include <vector>

namespace hilda::granular {

struct SolidBody {
    double mass;              ///< [kg]
    Inertia inertia;          ///< about the centre of mass, in the frame of the solid
    Vec3 centre = {0, 0, 0};  ///< centre of mass [m], in the frame of the solid
};

/// Ball about the origin
SolidBody solid_ball(double density, double radius);
/// Frustum of these radii at the origin and at length axis. V = π L/3 (a² + a b + b²)
SolidBody solid_frustum(double density, const Vec3& axis, double length, double a, double b);
/// Ring torus about the origin, with the tube radius `radius`. V = 2 π² A a²
SolidBody solid_torus(double density, const Vec3& axis, double radius, double ring_radius);

/// The body of several solids, each with the place of its centre and the rotation of its frame. Frame: global
struct PlacedSolid {
    SolidBody solid;
    Vec3 r;  ///< of the centre of mass [m]
    EulerParameters<double> p;
};
SolidBody sum(const std::vector<PlacedSolid>& all);

}  // namespace hilda::granular
