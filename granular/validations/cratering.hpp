// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball that falls on a bed of grains in a box of 9 cm × 9 cm; see cratering.cpp.

#pragma once

#include "granular/validations/validation.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::granular {

/// A bed at rest and what is measured on it
struct SettledBed {
    std::string bytes;   ///< state of the world
    double surface = 0;  ///< mean height of the surface [m]
    double density = 0;  ///< bulk density [kg/m³]
};

/// What determines the bed of grains of radius R
BedCase bed_case(double R);

/// A bed of grains of radius R [m] and about 10 cm depth, from ValidationOptions::beds if it is kept there.
/// `progress` receives values from 0 to 1. Throws io::NumericalFailure if the bed does not settle.
SettledBed settled_bed(
    double R, const ValidationOptions& options, const std::function<void(double)>& progress = [](double) {});

struct Impact {
    double R, density, height;  ///< of the grains, of the ball, of its fall [m, kg/m³, m]
};

struct Crater {
    double depth = 0;  ///< of the lowest point of the ball below the surface when it is at rest [m]
    double time = 0;   ///< from the first contact until then [s]
    struct Sample {
        double t, depth, speed;  ///< speed downward [s, m, m/s]
        bool operator==(const Sample&) const = default;
    };
    std::vector<Sample> motion;
};

/// The impact on a bed of the same R. Throws io::NumericalFailure if the ball does not come to rest.
Crater impact(const Impact& of, const SettledBed& bed, const ValidationOptions& options);

}  // namespace hilda::granular
