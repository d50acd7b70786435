// SPDX-License-Identifier: GPL-3.0-or-later
/// Run of a case: steps, output, checkpoints and resumption.

#pragma once

#include "granular/program/arguments.hpp"

namespace hilda::granular {

/// Runs a case to its end and returns the exit code. Throws io::InvalidInput, io::IoError, DeviceError.
int run(const Options& options, Case c);

}  // namespace hilda::granular
