// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda cosim: a mechanism and grains that advance together.

#pragma once

#include "run/run_options.hpp"

namespace hilda::run {

struct CosimOptions {
    std::string file;
    /// in-process; pipe: the grains are a process of hilda-granular; mpi: they are rank 1 of mpirun
    std::string transport = "in-process";
    RunOptions run = {};  ///< output, checkpoints and switches; the model and its step are those of the file
};

/// Simulates both sides, writes the results of the mechanism to the output directory and those of the grains
/// to its folder grains/, and prints a summary. Returns the exit code.
int run_cosim(const CosimOptions& options);

}  // namespace hilda::run
