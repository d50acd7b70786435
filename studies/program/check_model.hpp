// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda check: validates a model and prints its properties without a simulation.

#pragma once

#include "run/check_options.hpp"

namespace hilda::studies {

/// Prints the numbers of bodies, constraints, forces and contacts, the rank of the constraints, the initial
/// residuals, the energy and the largest reactions. Returns the exit code. Writes the file
/// `write` only, which implies fix_initial. lie::InvalidInput for an invalid model.
int check_model(const run::CheckOptions& options);

}  // namespace hilda::studies
