// SPDX-License-Identifier: GPL-3.0-or-later
/// Time measurement of runs: thread CPU time, median of repeated measurements.

#pragma once

#include "lie/settings.hpp"
#include "studies/framework/run.hpp"

namespace hilda::studies {

/// Median and range of repeated measurements
struct Spread {
    double median = 0, least = 0, most = 0;
};
/// NaN for an empty list. The median of an even number of values is the mean of the two central ones.
Spread spread(std::vector<double> values);

/// A run with time measurements
struct TimedRun : Run {
    std::vector<double> repeat;  ///< thread CPU time of each integration [s]; empty if the run failed

    Spread seconds_of_repeats() const { return spread(repeat); }
    /// Time of a step [µs]
    Spread microseconds() const;
};

/// Ratio of the times of a and b: the median of the ratios of corresponding repeats, which is robust against
/// a temporary load of the machine. NaN if one of the runs failed.
double ratio(const TimedRun& a, const TimedRun& b);

/// Thread CPU time of the integration of a run without observers [s]. A run shorter than 20 ms is repeated
/// until 20 ms have passed, and the mean is returned. The construction of the integrator is not included.
double seconds_of_march(const Run& run, const lie::Settings& of_study);

/// Settings of the k-th run
using SettingsOf = std::function<lie::Settings(long k)>;

/// Measures each run that has not failed options.repeats times. All runs are measured once, then all again,
/// so that a temporary load of the machine does not affect all repeats of one run.
void time_in_turn(const std::string& label, const StudyOptions& options, const std::vector<TimedRun*>& runs,
                  const SettingsOf& settings);

/// Exponent p of y ~ x^p, by linear least squares of log y over log x
struct Exponent {
    double fitted = 0;         ///< NaN for fewer than two points
    double largest_local = 0;  ///< largest exponent between neighbouring points
};
Exponent exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace hilda::studies
