// SPDX-License-Identifier: GPL-3.0-or-later
/// Checkpoints: the state of a run between two steps. A run resumed from a checkpoint gives the same digits
/// as an uninterrupted run.

#pragma once

#include "run/columns/invariants.hpp"
#include "run/recording/run_settings.hpp"
#include "run/recording/simulation_record.hpp"
#include "run/tables/sink.hpp"

#include <map>
#include <string>

namespace hilda::run {

/// The record of the simulation, and what the outputs of a run need
struct Checkpoint : SimulationRecord {
    RunSettings settings;  ///< a resumed run must have the same
    double end = 0;        ///< of the run [s]; a resumed run may have a later one
    long interval = 1;     ///< nodes from one output row to the next
    Invariants invariants;
    StepCost last_step;
    std::map<std::string, std::string> sinks;  ///< see io::Sinks
    double wall_seconds = 0;
};

/// Serialises a checkpoint.
std::string to_bytes(Checkpoint checkpoint);
/// Inverse of to_bytes(). `file` is for the message. io::IoError if the bytes are damaged or of another
/// version.
Checkpoint from_bytes(const std::string& bytes, const std::string& file);

/// io::IoError if the checkpoint does not fit the model and its initial state x.
void check_fits(const Checkpoint& checkpoint, const dae::Model& model, const lie::State& x,
                const std::string& file);

}  // namespace hilda::run
