// SPDX-License-Identifier: GPL-3.0-or-later
/// Flow of grains in a rotating drum with a rough shell; see drum.cpp.

#pragma once

#include "granular/validations/validation.hpp"

#include <functional>
#include <vector>

namespace hilda::granular {

/// A drum about the y axis, half filled with equal grains
struct Drum {
    double radius = 0.03;  ///< of the circle of the centres of the shell grains [m]
    double width = 4e-3;   ///< distance of the end walls [m]
    double R = 5e-4;       ///< radius of the grains [m]
    double E = 7e6;        ///< Young's modulus [Pa]
    double g = 9.81;       ///< [m/s²]
    double h = 8e-6;       ///< step [s]
};

/// What determines the settled grains
BedCase bed_case(const Drum& drum);

/// Centres of the settled grains below the axis, from ValidationOptions::beds if they are kept there.
/// `progress` receives values from 0 to 1. Throws io::NumericalFailure if the grains do not settle.
std::vector<Vec3> settled_grains(
    const Drum& drum, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

struct DrumRun {
    Drum drum = {};
    double froude = 0.1;    ///< ω² radius/g
    double turns = 1;       ///< of the drum
    double averaged = 0.5;  ///< turns at the end over which the quantities are averaged

    double omega() const;  ///< [rad/s]
};

/// The flow over the last turns. x is horizontal, z is vertical, and the drum lifts grains at x < 0.
struct DrumFlow {
    double angle = 0;  ///< of the surface, from its middle part [°]
    /// Angle between the vertical and the line from the axis to the centre of mass [°]
    double centre_angle = 0;
    double airborne = 0;  ///< share of the grains that fall freely
    double covered = 0;   ///< share of the rim with grains that move with the shell: least of all samples
    std::vector<double> x, surface;  ///< of each column: its middle, height of the surface; NaN: none [m]
    struct SliceGrain {
        double x, z, speed;  ///< [m, m, ω radius]
    };
    std::vector<SliceGrain> slice;  ///< grains in the middle slice at the end
    std::vector<Vec3> centres;      ///< of all grains at the end
};

/// The flow of the settled grains of the same drum.
DrumFlow flow(const DrumRun& run, const std::vector<Vec3>& grains, const ValidationOptions& options);

/// Least-squares angle of the surface over |x| < 0.4 radius [°]; positive if it falls with x
double surface_angle(const std::vector<double>& x, const std::vector<double>& surface, double radius);

}  // namespace hilda::granular
