// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda run: simulates one model, with one or more integrators in sequence.

#pragma once

#include "run/run_options.hpp"

namespace hilda::studies {

/// Simulates the model with each integrator, writes the results and prints a summary. Returns the exit code
/// of the first run that did not succeed. With more than one integrator the results are in subdirectories
/// named by integrator. io::UsageError for options that do not apply, before the first run starts.
int run_model(const run::RunOptions& options);

}  // namespace hilda::studies
