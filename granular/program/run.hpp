// SPDX-License-Identifier: GPL-3.0-or-later
/// A case run to its end: what is written on the way, and how it goes on after it was stopped.

#pragma once

#include "granular/program/arguments.hpp"

#include <csignal>

namespace hilda::granular {

/// The signal that asks to stop, or 0
extern volatile std::sig_atomic_t caught;

/// Returns an exit code. InvalidCase, FileError.
int run(const Options& options, Case c);

}  // namespace hilda::granular
