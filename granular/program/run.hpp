// SPDX-License-Identifier: GPL-3.0-or-later
/// Run of a case: steps, output, checkpoints and resumption.

#pragma once

#include "granular/program/arguments.hpp"
#include "granular/stages/continuation.hpp"

#include <functional>

namespace hilda::granular {

/// Runs a case to its end and returns the exit code. `read_again` reads the same case, for the state before a
/// numerical failure. Throws io::InvalidInput, io::IoError, DeviceError.
int run(const Options& options, Continuation run, const std::function<Continuation()>& read_again);

}  // namespace hilda::granular
