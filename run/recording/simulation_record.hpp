// SPDX-License-Identifier: GPL-3.0-or-later
/// What a continued simulation needs of the steps before it. With it, the same digits follow as without the
/// interruption.

#pragma once

#include "contact/evolving/unilateral.hpp"
#include "lie/statistics.hpp"
#include "run/watch/watch.hpp"

#include <string>

namespace hilda::run {

struct SimulationRecord {
    lie::State node;     ///< last accepted node
    long number = 0;     ///< number of that node
    int iterations = 0;  ///< Newton iterations of the step that ends there
    lie::State
        pivots;  ///< state of the last choice of pivots (see PivotNode); no bodies: pivots not chosen yet
    lie::Statistics statistics;  ///< of the steps up to the node
    WatchRecord watch;
    contact::UnilateralStep::History contacts;  ///< of unilateral contacts
    std::string events;                         ///< see RunEvents::save(); empty if the run has none
};

/// Writes or reads a state.
void transfer_state(io::Archive& a, lie::State& x);
/// Writes or reads the record.
void transfer(io::Archive& a, SimulationRecord& record);

/// io::IoError if the record does not fit the model and its initial state x. `file` is for the message.
void check_fits(const SimulationRecord& record, const dae::Model& model, const lie::State& x,
                const std::string& file);

}  // namespace hilda::run
