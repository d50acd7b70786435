// SPDX-License-Identifier: GPL-3.0-or-later
/// Run of a case: steps, output, checkpoints and resumption.

#pragma once

#include "granular/program/arguments.hpp"

#include <csignal>

namespace hilda::granular {

/// Number of the signal that requested the end of the run, or 0
extern volatile std::sig_atomic_t caught;

/// Runs a case to its end and returns the exit code. Throws InvalidCase, FileError, DeviceError.
int run(const Options& options, Case c);

}  // namespace hilda::granular
