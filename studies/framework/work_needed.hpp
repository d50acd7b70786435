// SPDX-License-Identifier: GPL-3.0-or-later
/// Computing time that an integrator needs for a given accuracy, from runs of increasing cost.

#pragma once

#include <vector>

namespace hilda::studies {

struct WorkNeeded {
    double seconds = 0;    ///< NaN: the accuracy is not reached
    bool at_most = false;  ///< upper bound only: the cheapest successful run is already more accurate
};

/// Time at which the error equals `accuracy`, by linear interpolation of log t over log e between the first
/// run that is at least as accurate and its predecessor. Errors and times [s] start with the coarsest run;
/// NaN for a failed run.
WorkNeeded work_needed(const std::vector<double>& error, const std::vector<double>& seconds, double accuracy);

}  // namespace hilda::studies
