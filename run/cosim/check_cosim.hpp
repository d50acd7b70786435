// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda check of a co-simulation file.

#pragma once

#include "run/check_options.hpp"

namespace hilda::run {

/// Reads the model and the case of the file, compares them, and prints the steps and the stability limit of
/// each body, without a simulation. Returns the exit code. Throws io::InvalidInput for invalid or
/// inconsistent files and for a step above the stability limit, and io::UsageError for options that are
/// valid for models only.
int check_cosim(const CheckOptions& options);

}  // namespace hilda::run
