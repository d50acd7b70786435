// SPDX-License-Identifier: GPL-3.0-or-later
/// Drum with grains of two sizes, case 2 of the comparison of codes for bulk processes; see mixing_drum.cpp.

#pragma once

#include "granular/validations/comparison/bulk_materials.hpp"
#include "granular/validations/validation.hpp"

namespace hilda::granular {

/// A drum about the y axis with grains M2 below grains M1
struct MixingDrum {
    long of_M1 = 30000, of_M2 = 8000;  ///< published numbers of grains
    BulkScale scale = {};
    double omega = 2;      ///< angular velocity, about -y [rad/s]
    double time = 5;       ///< [s]
    double sample = 0.05;  ///< interval of the samples [s]

    double radius(BulkMaterial material) const { return (material == M1 ? 1e-3 : 2e-3) * scale.size; }
    long number(BulkMaterial material) const { return scale.number(material == M1 ? of_M1 : of_M2); }
    double h() const { return bulk_step(radius(M1), M1, scale); }
};

/// Samples over time. Zone 1: x > 0 and z > 0, zone 2: x < 0 and z < 0.
struct DrumMixing {
    std::vector<double> t;
    std::vector<double> zone1_M1, zone1_M2, zone2_M1, zone2_M2;  ///< numbers of grains
    std::vector<double> separation;  ///< distance of the centres of mass of M1 and M2 over the radius
    std::vector<double>
        centre_angle;  ///< angle between the vertical and the line from the axis to the centre of mass [°]
    std::vector<double>
        torque;  ///< of the grains on the drum against its rotation, mean over the interval [N m]
    std::vector<double> gravity;  ///< moment of the weight of the grains about the axis, the same mean [N m]
    struct SliceGrain {
        double t, x, z, radius;  ///< [s, m, m, m]
        int material;
    };
    /// Grains with |y| below the larger radius at the start, after 0.3 of the time and at the end
    std::vector<SliceGrain> slices;
    double work = 0;  ///< of the drum on the grains [J]
    double gain = 0;  ///< of the energy of the grains [J]
    double lost = 0;  ///< number of grains that are missing at the end
};

/// Settles the grains and rotates the drum. `progress` receives values from 0 to 1. Throws
/// io::NumericalFailure if the grains do not settle.
DrumMixing drum_mixing(
    const MixingDrum& drum, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace hilda::granular
