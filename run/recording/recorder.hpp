// SPDX-License-Identifier: GPL-3.0-or-later
/// The outputs of a run during the time integration, and the contents of its checkpoints.

#pragma once

#include "run/recording/checkpoint.hpp"
#include "run/tables/sink.hpp"
#include "run/watch/watch.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace hilda::lie {
class Integrator;
}

namespace hilda::run {

/// The state at which the integrator last chose the pivots of its sparse factorisation
/// (Integrator::pivots()). For a scheme that does not provide this state, the node at the start of the step
/// in which it chose them.
///
/// The pivots are the only data of a fixed-step scheme outside the state. A new integrator that chooses
/// its pivots at the same state gives the same digits from there on.
class PivotNode final : public lie::Observer {
public:
    explicit PivotNode(lie::Integrator& integrator) : integrator(integrator) {}

    void accepted(const lie::State& x, long n, int iterations) override;
    /// Makes a new integrator choose its pivots at the state `from`; h: step [s]
    void restore(const lie::State& from, double h);

    lie::State node;

private:
    lie::Integrator& integrator;
    long last_count = 0;
};

/// Passes the nodes of a run to its sinks, with their energy and residual; collects extreme values and the
/// contents of checkpoints.
class Recorder final : public lie::Observer {
public:
    /// Makes the sinks that the options of the run request. io::UsageError. The objects must outlive this
    /// one.
    Recorder(const RunSetup& run, lie::Integrator& integrator, Watch& watch);

    /// Opens the sinks and starts to measure times. With a checkpoint, continues the sinks and restores the
    /// counters and the pivots of the integrator. io::IoError.
    void open(const std::optional<Checkpoint>& from);
    /// lie::NodeFailure "constraint_drift" at the first node where a constraint row that was dropped as
    /// redundant is violated.
    void accepted(const lie::State& x, long n, int iterations) override;
    /// PivotNode and this object, to be called before the Watch
    std::vector<lie::Observer*> observers() { return {&pivots, this}; }

    /// Counters of the whole run, from those of the part after the checkpoint
    lie::Statistics statistics(const lie::Statistics& of_this_part) const;
    /// Synchronises the files with the disk and returns a checkpoint of the current node. The caller sets the
    /// members `settings` and `wall_seconds`.
    Checkpoint checkpoint(const lie::March& march);
    /// Ends all files. io::IoError.
    void close() { sinks.close(); }
    std::vector<std::string> files() const { return sinks.files(); }

    Invariants invariants;

private:
    using Clock = std::chrono::steady_clock;

    const dae::Model& model;
    const lie::TimeGrid& grid;
    lie::Integrator& integrator;
    Watch& watch;
    io::Sinks<RunSetup> sinks;
    std::vector<const contact::EvolvingContact*> contacts;
    PivotNode pivots;
    lie::Statistics earlier_statistics;  ///< of the part of the run before the checkpoint
    /// Cost of the step that ends at the current node. The node is passed on after the following step,
    /// because schemes with staggered velocities fill the node only then.
    StepCost last;
    long factorizations = 0;
    Clock::time_point since;
};

}  // namespace hilda::run
