// SPDX-License-Identifier: GPL-3.0-or-later
/// The outputs of a run during the time integration, and the contents of its checkpoints.

#pragma once

#include "run/recording/checkpoint.hpp"
#include "run/tables/sink.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace hilda::lie {
class Integrator;
}

namespace hilda::run {

/// Passes the nodes of a run to its sinks, with their energy and residual; collects extreme values and the
/// contents of checkpoints.
class Recorder final : public lie::Observer {
public:
    /// Makes the sinks that the options of the run request. io::UsageError. The objects must outlive this
    /// one.
    Recorder(const RunSetup& run, const lie::Integrator& integrator);

    /// Opens the sinks and starts to measure times. With a checkpoint, continues the sinks; the simulation
    /// has been resumed before. io::IoError.
    void open(const std::optional<Checkpoint>& from);
    /// lie::NodeFailure "constraint_drift" at the first node where a constraint row that was dropped as
    /// redundant is violated.
    void accepted(const lie::State& x, long n, int iterations) override;
    /// Synchronises the files with the disk and returns a checkpoint of the node of the record. The caller
    /// sets the members `settings` and `wall_seconds`.
    Checkpoint checkpoint(SimulationRecord of_simulation);
    /// Ends all files. io::IoError.
    void close() { sinks.close(); }
    std::vector<std::string> files() const { return sinks.files(); }

    Invariants invariants;

private:
    using Clock = std::chrono::steady_clock;

    const dae::Model& model;
    const lie::TimeGrid& grid;
    const lie::Integrator& integrator;
    io::Sinks<RunSetup> sinks;
    std::vector<const contact::EvolvingContact*> contacts;
    /// Cost of the step that ends at the current node. The node is passed on after the following step,
    /// because schemes with staggered velocities fill the node only then.
    StepCost last;
    long factorizations = 0;
    Clock::time_point since;
};

}  // namespace hilda::run
