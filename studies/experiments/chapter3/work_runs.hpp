// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs with their errors and CPU times, for studies of the error against the CPU time.

#pragma once

#include "studies/framework/errors.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/sweep.hpp"
#include "studies/framework/work_needed.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

struct WorkRun : TimedRun {
    Errors errors;

    void transfer(io::Archive& a);
};

/// Runs of one scheme on one benchmark, by decreasing step or tolerance
using WorkSeries = std::vector<const WorkRun*>;

/// The integrators, and the steps [s] or relative tolerances of their runs
struct WorkGrid {
    /// Those of the options, or else these. Schemes with both forms have adaptive steps.
    WorkGrid(const StudyContext& study, const std::vector<std::string>& schemes,
             const std::vector<double>& steps, const std::vector<double>& rtols);
    Evaluated finest() const { return studies::finest(schemes, steps.back(), rtols.back()); }

    Schemes schemes;
    std::vector<double> steps, rtols;
};

/// Computes the reference solutions of the benchmarks, the errors of the runs, and then their CPU times. The
/// benchmarks must outlive the runs.
Sweep<WorkRun> work_runs(const StudyContext& study, const WorkGrid& grid, const Reference& reference,
                         std::vector<Benchmark>& benchmarks);

/// CPU time, errors in all norms, and counters
Columns<WorkRun> columns_of_work();

/// CPU time for an rms error of r [m]
WorkNeeded work_needed(const WorkSeries& series, double accuracy);
/// The time in milliseconds, such as "<= 1.25"; "-" if the accuracy is not reached
std::string milliseconds(const WorkNeeded& work, int digits);

}  // namespace hilda::studies
