// SPDX-License-Identifier: GPL-3.0-or-later
/// Steps of a run whose rigid contacts satisfy their law with restrictions only.

#pragma once

#include "lie/statistics.hpp"
#include "run/watch/watch.hpp"

#include <vector>

namespace hilda::run {

/// Findings "friction_relaxed", "restitution_reduced", and "rigid_overlap" for an overlap above 10⁻⁶ of the
/// size of a body
std::vector<Finding> rigid_contact_findings(const lie::Statistics& of);

}  // namespace hilda::run
