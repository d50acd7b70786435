// SPDX-License-Identifier: GPL-3.0-or-later
/// What an integrator needs for an accuracy, from runs of growing cost.

#pragma once

#include <vector>

namespace hilda::studies {

struct WorkNeeded {
    double seconds = 0;    ///< NaN: the accuracy is not reached
    bool at_most = false;  ///< the cheapest run that ended well is more accurate already
};

/// The time at which the error comes down to `asked`: on the straight line in log e, log t between the first
/// run that is as accurate and the one before it. Errors and times from the coarsest run on; NaN where one
/// failed.
WorkNeeded work_needed(const std::vector<double>& error, const std::vector<double>& seconds, double asked);

}  // namespace hilda::studies
