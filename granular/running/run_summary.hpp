// SPDX-License-Identifier: GPL-3.0-or-later
/// summary.json of a run of a case.

#pragma once

#include "granular/running/run_options.hpp"
#include "granular/stages/change_history.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

struct Case;

/// How a run has ended
struct RunEnd {
    const std::string &status, &message;  ///< message: of a failure; otherwise empty
    int code;                             ///< exit code
    long rows;                            ///< of run.csv
    long resumed_at;                      ///< number of the step; 0: not resumed
    double seconds, particle_steps;       ///< wall time of the steps [s]; sum of their numbers of particles
    std::vector<std::string> files;       ///< written into the directory
};

io::Json run_summary(const RunOptions& options, const Case& c, const ChangeHistory& history,
                     const RunEnd& end);

}  // namespace hilda::granular
