// SPDX-License-Identifier: GPL-3.0-or-later
/// Time measurement of runs: thread CPU time, median of repeated measurements.

#pragma once

#include "studies/framework/acceptance.hpp"
#include "studies/framework/sweep.hpp"

namespace hilda::studies {

/// Median and range of repeated measurements
struct Spread {
    double median = 0, least = 0, most = 0;
};
/// NaN for an empty list. The median of an even number of values is the mean of the two central ones.
Spread spread(std::vector<double> values);

/// A run with time measurements
struct TimedRun : Run {
    std::vector<double> repeat;   ///< thread CPU time of each integration [s]; empty if the run failed
    double ratio = std::nan("");  ///< of the time to that of a baseline, see set_ratios

    /// Without the repeats, whose results time_in_turn() transfers
    void transfer(io::Archive& a) { Run::transfer(a); }
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

/// Measures each run that has not failed --repeats times. All runs are measured once, then all again, so that
/// a temporary load of the machine does not affect all repeats of one run.
void time_in_turn(const StudyContext& study, const std::vector<TimedRun*>& runs);
template <class Timed>
void time_in_turn(const StudyContext& study, std::vector<Timed>& runs)
{
    time_in_turn(study, pointers<TimedRun*>(runs));
}

/// Sets the ratio of each run to the run of the baseline scheme on the same benchmark with the same step.
template <class Timed>
void set_ratios(std::vector<Timed>& runs, const std::string& baseline)
{
    for (Timed& run : runs)
        for (const Timed& of : runs)
            if (of.c == run.c && of.h == run.h && of.scheme->name == baseline) run.ratio = ratio(run, of);
}

/// For each run of rA-half-1 the bounds of its ratio to rA-full-1. They are wide, because a loaded machine
/// disturbs the times.
template <class Timed>
std::vector<Criterion> criteria_of_times(const std::vector<Timed>& runs)
{
    std::vector<Criterion> all;
    for (const Timed& run : runs)
        if (run.scheme->name == "rA-half-1")
            all.push_back(
                between("CPU time of a step over that of rA-full-1, " + run.name(), run.ratio, 0.4, 1.25));
    return all;
}

namespace column {

inline const Column<TimedRun> cpu_seconds_of_repeats("cpu_seconds", [](const TimedRun& run) {
    return run.seconds_of_repeats().median;
});

}  // namespace column

/// Columns of the time of a step [µs], and of its ratio to that of the baseline
template <class Timed = TimedRun>
Columns<Timed> columns_of_times(const std::string& baseline, const std::string& format = "{:.3f}")
{
    return {{"us_per_step", "us/step", format, [](const Timed& run) { return run.microseconds().median; }},
            {"us_per_step_min", "min", format, [](const Timed& run) { return run.microseconds().least; }},
            {"us_per_step_max", "max", format, [](const Timed& run) { return run.microseconds().most; }},
            {"ratio_to_full", "time / " + baseline, "{:.3f}", &Timed::ratio}};
}

/// Exponent p of y ~ x^p, by linear least squares of log y over log x
struct Exponent {
    double fitted = 0;         ///< NaN for fewer than two points
    double largest_local = 0;  ///< largest exponent between neighbouring points
};
Exponent exponent(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace hilda::studies
