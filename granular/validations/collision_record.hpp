// SPDX-License-Identifier: GPL-3.0-or-later
/// Analysis of the vertical motion of a projectile that hits a bed of grains: filtered acceleration, depth
/// and duration of the collision.                                                Fang (2022), Sec. 7.2.4

#pragma once

#include <cstddef>
#include <vector>

namespace hilda::granular {

/// Butterworth low-pass filter of second order without phase shift: applied forwards, then backwards.
///
///     H(s) = 1/(1 + √2 s/ω_c + (s/ω_c)²) once in each direction,  by the bilinear transformation
///
/// The gain is 1 - at ω = 0, 1/2 at the cut-off frequency and 0 at half of the sampling rate. The signal is
/// continued beyond its ends by its reflection at the end points, x(-t) = 2 x(0) - x(t), for three periods of
/// the cut-off frequency. rate: samples per second, more than twice the cut-off frequency [Hz].
std::vector<double> low_pass(const std::vector<double>& x, double cut_off, double rate);

/// Vertical motion of a projectile, sampled at equal intervals. It begins in free fall. Positive is upwards.
struct CollisionRecord {
    double interval = 0;        ///< [s]
    double g = 0;               ///< gravity [m/s²]
    std::vector<double> z;      ///< height of the lowest point [m]
    std::vector<double> v, a;   ///< velocity and acceleration [m/s, m/s²]
    std::vector<double> a_low;  ///< acceleration after low_pass() [m/s²]
};

/// Quantities of a collision. Times and depths count from the last sample in free fall.
struct Collision {
    std::size_t start = 0, end = 0;  ///< samples: the last in free fall, and that of the stop
    double speed = 0;                ///< downward, at the start [m/s]
    double depth = 0, time = 0;      ///< at the stop [m, s]
    double peak = 0;                 ///< largest filtered acceleration [m/s²]
    bool slowed = false;             ///< the projectile was slower than 1 cm/s after the peak
};

/// Speed below which the projectile is nearly at rest [m/s]
constexpr double slow_speed = 0.01;

/// The collision of a record with filtered acceleration. The stop is the first sample with a_low < 0.1 g
/// after 0.9 t_s. t_s is the first time after the peak with |v| < slow_speed; without one, both are the end
/// of the record.                          As in the post-processing of the dissertation's simulations
Collision collision(const CollisionRecord& record);

}  // namespace hilda::granular
