// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of the step of a case with World::step_limits.

#pragma once

#include "granular/case/case_file.hpp"

#include <functional>

namespace hilda::granular {

/// The smaller of the Rayleigh time and 2/π of the collision time [s]
double stability_limit(const World::StepLimits& of);

/// Receives the pointer of an entry and what is wrong.
using StepFinding = std::function<void(const std::string& pointer, const std::string& what)>;

/// Calls `above` for a step above the stability limit, at /step and at each stage whose laws have a smaller
/// limit, and `coarse` for one above 1/5 of the Rayleigh time or 1/15 of the collision time. Throws
/// io::PlacedError if the run has no step.
void check_step(const Case& c, const StepFinding& above, const StepFinding& coarse);

}  // namespace hilda::granular
