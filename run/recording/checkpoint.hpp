// SPDX-License-Identifier: GPL-3.0-or-later
/// Checkpoints: the state of a run between two steps. A run resumed from a checkpoint gives the same digits
/// as an uninterrupted run.

#pragma once

#include "contact/evolving/unilateral.hpp"
#include "lie/statistics.hpp"
#include "run/columns/invariants.hpp"
#include "run/recording/run_settings.hpp"
#include "run/tables/sink.hpp"
#include "run/watch/watch.hpp"

#include <map>
#include <string>

namespace hilda::run {

struct Checkpoint {
    RunSettings settings;  ///< a resumed run must have the same
    double end = 0;        ///< of the run [s]; a resumed run may have a later one
    long interval = 1;     ///< nodes from one output row to the next
    lie::State node;       ///< last accepted node
    long number = 0;       ///< number of that node
    int iterations = 0;    ///< Newton iterations of the step that ends there
    lie::State
        pivots;  ///< state of the last choice of pivots (see PivotNode); no bodies: pivots not chosen yet
    lie::Statistics statistics;
    Invariants invariants;
    WatchRecord watch;
    contact::UnilateralStep::History contacts;  ///< of unilateral contacts
    StepCost last_step;
    std::map<std::string, std::string> sinks;  ///< see io::Sinks
    double wall_seconds = 0;
};

/// Writes or reads a state.
void transfer_state(io::Archive& a, lie::State& x);
/// Serialises a checkpoint.
std::string to_bytes(Checkpoint checkpoint);
/// Inverse of to_bytes(). `file` is for the message. io::IoError if the bytes are damaged or of another
/// version.
Checkpoint from_bytes(const std::string& bytes, const std::string& file);

/// io::IoError if the checkpoint does not fit the model and its initial state x.
void check_fits(const Checkpoint& checkpoint, const dae::Model& model, const lie::State& x,
                const std::string& file);

}  // namespace hilda::run
