// SPDX-License-Identifier: GPL-3.0-or-later
/// Run of a case: steps, output, checkpoints and resumption.

#pragma once

#include "granular/running/run_options.hpp"
#include "granular/stages/continuation.hpp"

#include <functional>
#include <memory>

namespace hilda::granular {

/// Runs a case to its end and returns the exit code. `read_again` reads the same case, for the state before a
/// numerical failure. Throws io::InvalidInput, io::IoError, DeviceError.
int run(const RunOptions& options, Continuation run, const std::function<Continuation()>& read_again);

/// A run whose steps another program commands: a co-simulation. The functions throw io::InvalidInput,
/// io::IoError, DeviceError and io::NumericalFailure.
class SteppedRun {
public:
    /// Checks the case, inserts its particles, and restores the last checkpoint of a resumed run. `restore`:
    /// the number of steps of the checkpoint that is to be restored; negative: the last one. io::IoError if
    /// there is no such checkpoint.
    static std::unique_ptr<SteppedRun> open(const RunOptions& options, Continuation run, long restore = -1);
    virtual ~SteppedRun() = default;

    virtual Case& case_of_run() = 0;
    /// Computes a step and writes the outputs of its end.
    virtual void step() = 0;
    /// Writes a checkpoint.
    virtual void save() = 0;
    /// Writes the remaining outputs, with this exit code in the summary.
    virtual void close(int code) = 0;
};

}  // namespace hilda::granular
