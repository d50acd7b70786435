// SPDX-License-Identifier: GPL-3.0-or-later
/// Wheel with prescribed slip on a bed of grains; see wheel.cpp.

#pragma once

#include "granular/validations/validation.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace hilda::granular {

/// Shape of a wheel. The cylinder is an analytic surface, the others are meshes.
enum class WheelShape {
    cylinder,         ///< as wide as the period of the bed (plane strain)
    prism,            ///< the same cylinder as a prism of 96 sides
    closed_cylinder,  ///< cylinder of the width of 16 cm, with end faces
    tyre              ///< torus of the width of 16 cm
};
/// In tables: "cylinder", "prism", "cylinder with ends", "tyre"
const char* name_of(WheelShape shape);

/// A bed of equal grains that is periodic along y, the axis of the wheel
struct WheelBed {
    double length = 0.7;       ///< along x, between end walls [m]
    double width = 0.06;       ///< period along y [m]
    double depth = 0.10;       ///< approximate depth of the settled bed [m]
    double R = 7.5e-3;         ///< radius of the grains [m]
    double k = 1e6;            ///< normal and tangential stiffness at an overlap of R [N/m]
    double settling_mu = 0.1;  ///< coefficient of friction during the settling; it determines the packing
    double h = 5e-5;           ///< step [s]
    std::uint64_t seed = 1;    ///< of the random displacements from which it settles
};

/// What determines the settled bed
BedCase bed_case(const WheelBed& bed);

/// Centres of the settled grains, from ValidationOptions::beds if they are kept there. `progress` receives
/// values from 0 to 1. Throws io::NumericalFailure if the bed does not settle.
std::vector<Vec3> settled_soil(
    const WheelBed& bed, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

struct WheelTest {
    WheelBed bed = {};
    WheelShape shape = WheelShape::cylinder;
    double mu_r = 0.2;       ///< coefficient of rolling friction
    double slip = 0;         ///< 1 - v/(ω radius)
    double duration = 5;     ///< of the motion [s]
    double averaged = 0.5;   ///< share of the duration over which means are taken, at its end
    double interval = 0.05;  ///< between rows of the record [s]
};

/// Result of a wheel test. In plane strain the loads and powers are those of a width of 16 cm, the width of
/// the wheel of the dissertation.
struct WheelRecord {
    /// Means over the intervals: end of the interval [s], pull (F_x) and vertical load [N], driving torque
    /// [N m], sinkage [m]
    std::vector<double> t, pull, load, torque, sinkage;
    double from = 0;        ///< start of the averaging: of the first interval in this share [s]
    double power = 0;       ///< mean of torque ω - pull v after `from` [W]
    double dissipated = 0;  ///< mean dissipation of the contacts of the grains after `from` [W]
    struct Grain {
        double x, z, speed;  ///< [m, m, m/s]
    };
    std::vector<Grain> grains;        ///< all at the end
    double wheel_x = 0, wheel_z = 0;  ///< axis of the wheel at the end [m]

    struct Mean {
        double value = 0, deviation = 0;
    };
    /// Mean and standard deviation of a column over the intervals that end after a time
    Mean mean(const std::vector<double>& column, double after) const;
    /// Appends the columns of the loads and the sinkage of the same test on another bed, and adds the powers.
    void append(const WheelRecord& other);
};

/// The test on a settled bed with the same parameters.
WheelRecord drive(const WheelTest& test, const std::vector<Vec3>& soil, const ValidationOptions& options);

}  // namespace hilda::granular
