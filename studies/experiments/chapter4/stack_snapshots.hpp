// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of stacks of three spheres that stand or collapse.                  Fang (2022), Fig. 4.19 b-g

#pragma once

#include "run/frames/tables.hpp"
#include "studies/experiments/chapter4/stack.hpp"

namespace hilda::studies {

/// A stack before and after its motion
struct StackSnapshots {
    Stack stack;
    bool collapses = false;
    double t = 0;  ///< time of the second snapshot [s]; the first is at 0
    /// The rolling and the sliding spring of the right lower sphere on the ground were at their bounds, until
    /// the upper sphere had descended by R/10
    bool roll_saturates = false, slide_saturates = false;
    run::SnapshotTables tables = {};
};

/// Integrates with step h [s] until the time `end` [s], or until the upper sphere has descended by R/2. `run`
/// is the name of the run in the tables.
StackSnapshots stack_snapshots(const Stack& stack, const std::string& run, double h, double end);

}  // namespace hilda::studies
