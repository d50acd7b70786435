// SPDX-License-Identifier: GPL-3.0-or-later
/// A case run to its end: what is written on the way, and how it goes on after it was stopped.

#pragma once

#include "granular/case_file.hpp"

#include <csignal>

namespace hilda::granular {

enum Exit { ok = 0, usage = 2, bad_case = 3, numerical = 4, io = 5, no_device = 7, by_signal = 128 };

struct Options {
    std::string file, output, device = "cpu";
    double checkpoint = 0;  ///< [s] of the clock; 0: none
    int threads = 0;
    bool quiet = false, force = false, resume = false, no_vtk = false;
};

/// The signal that asks to stop, or 0
extern volatile std::sig_atomic_t caught;

/// Returns an exit code. InvalidCase, FileError.
int run(const Options& options, Case c);

}  // namespace hilda::granular
