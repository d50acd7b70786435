// SPDX-License-Identifier: GPL-3.0-or-later
/// What a run costs: thread CPU time, the median of repeats.

#pragma once

#include "studies/framework/run.hpp"

namespace hilda::studies {

/// Of several measurements
struct Spread {
    double median = 0, least = 0, most = 0;
};
/// NaN of none; the median of an even number is the mean of the two in the middle.
Spread spread(std::vector<double> values);

/// A member that is timed
struct TimedRun : Run {
    std::vector<double> repeat;  ///< thread CPU time of each march [s]; none where it failed

    Spread seconds_of_repeats() const { return spread(repeat); }
    /// The same of a step [µs]
    Spread microseconds() const;
};

/// Time of a over that of b: the median over the repeats of the ratio within each, which a slow moment of the
/// machine does not move. NaN where one of them failed.
double ratio(const TimedRun& a, const TimedRun& b);

/// Thread CPU seconds of the march of a member with nothing observing it. Where it is over sooner than 20 ms it
/// is run again until they have passed, and the mean is taken. Making the integrator is not counted.
double seconds_of_march(const Run& member, const lie::Settings& of_study);

/// What the k-th of some members is run with
using SettingsOf = std::function<lie::Settings(long k)>;

/// Times those of the members that have not failed, each options.repeats times: all once, then all again, so
/// that a slow moment of the machine meets every one of them and not all repeats of one.
void time_in_turn(const std::string& label, const StudyOptions& options, const std::vector<TimedRun*>& runs,
                  const SettingsOf& settings);

/// Fits y ~ x^p by least squares on log x, log y
struct Exponent {
    double fitted = 0;         ///< NaN for fewer than two points
    double largest_local = 0;  ///< between neighbours
};
Exponent exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace hilda::studies
