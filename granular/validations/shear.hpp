// SPDX-License-Identifier: GPL-3.0-or-later
/// Direct shear of a sample of grains in a box of two halves; see shear.cpp.

#pragma once

#include "granular/validations/validation.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::granular {

/// A box of two halves, and the sample of equal grains in it
struct ShearBox {
    double edge = 0.12;    ///< edge b of the square section [m]
    double lower = 0.03;   ///< height of the lower half [m]; the shear plane is its upper edge
    double depth = 0.065;  ///< approximate height of the settled sample [m]
    double R = 3e-3;       ///< radius of the grains [m]
    double mu = 0.18;      ///< coefficient of friction between grains
    double h = 2e-5;       ///< step [s]
};

/// What determines the settled sample
BedCase bed_case(const ShearBox& box);

/// State of the world of the settled sample, from ValidationOptions::beds if it is kept there. `progress`
/// receives values from 0 to 1. Throws io::NumericalFailure if the sample does not settle.
std::string settled_sample(
    const ShearBox& box, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

/// The lid presses the sample for a time. Then the upper half and the lid move.
struct ShearTest {
    ShearBox box = {};
    double stress = 6.4e3;    ///< weight of the lid over b² [Pa]
    double speed = 0.01;      ///< of the upper half and of the lid [m/s]
    double distance = 6e-3;   ///< largest displacement of the upper half [m]
    double pressing = 0.4;    ///< time under the lid before the shear [s]
    double interval = 1e-4;   ///< displacement over which a row of the record is averaged [m]
    long between_loads = 25;  ///< steps between two evaluations of the loads
};

/// Result of a shear test. The columns have one mean for each interval of the displacement.
struct ShearRecord {
    /// Stress in the shear plane: weight of the lid and of the grains above the plane over b² [Pa]
    double sigma = 0;
    std::vector<double> x;         ///< displacement of the upper half, middle of the interval [m]
    std::vector<double> tau;       ///< shear stress (F_x of the lid + F_x of the upper half)/(b (b - x)) [Pa]
    std::vector<double> lid;       ///< height of the lid above its height at the start of the shear [m]
    std::vector<double> lid_load;  ///< vertical force of the grains on the lid over its weight
    std::vector<double> normal;    ///< vertical force through the shear plane over b (b - x) [Pa]
    /// Vertical load of the floor and of both halves over the weight of the lid and of all grains
    std::vector<double> support;

    struct Peak {
        double x = 0, tau = 0;
    };
    /// Largest mean of the shear stress over a displacement of `window` [m], and the middle of the window.
    /// The mean is NaN if that of one window is.
    Peak peak(double window = 5e-4) const;
    /// Mean of a column over x in (from, to)
    double mean(const std::vector<double>& column, double from, double to) const;
};

/// The shear test of a settled sample of the same box.
ShearRecord shear(const ShearTest& test, const std::string& sample, const ValidationOptions& options);

}  // namespace hilda::granular
