// SPDX-License-Identifier: GPL-3.0-or-later
/// Impact of a steel ball on a bed, case 3 of the comparison of codes for bulk processes; see
/// penetration.cpp.

#pragma once

#include "granular/validations/comparison/bulk_materials.hpp"
#include "granular/validations/validation.hpp"

namespace hilda::granular {

struct Penetration {
    long grains = 25000;  ///< published number
    BulkScale scale = {};
    double time = 0.1;     ///< [s]
    double sample = 5e-4;  ///< interval of the samples [s]

    double radius() const { return 1e-3 * scale.size; }  ///< of a grain [m]
    long number() const { return scale.number(grains); }
};

/// Centres of the grains at rest, z from the bottom of the box. They settle with ten times the softness.
/// Throws io::NumericalFailure if they do not settle.
std::vector<Vec3> penetration_bed(
    const Penetration& test, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

/// Motion of the ball, its centre above the bottom of the box
struct BallMotion {
    static constexpr double radius = 0.01, start = 0.150243, speed = 5;  ///< [m, m, m/s]

    std::vector<double> t, z, v;  ///< v upward
    double surface = 0;           ///< height of the bed: 98 % of the centres are below, plus a radius [m]
    double lost = 0;              ///< number of grains that are missing at the end

    std::size_t contact() const;  ///< last sample at which the ball is above the bed
    std::size_t stop() const;  ///< first sample at which it does not move down; the last one if there is none
    double depth() const { return surface - (z[stop()] - radius); }  ///< of the lowest point at the stop [m]
    double peak() const;  ///< largest mean acceleration over an interval [m/s²]
};

BallMotion ball_motion(const Penetration& test, const std::vector<Vec3>& bed,
                       const ValidationOptions& options);

}  // namespace hilda::granular
