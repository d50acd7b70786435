// SPDX-License-Identifier: GPL-3.0-or-later
/// The output files of a run during the time integration, and the contents of its checkpoints.

#pragma once

#include "io/output_file.hpp"
#include "lie/statistics.hpp"
#include "studies/running/checkpoint.hpp"
#include "studies/running/csv_steps.hpp"
#include "studies/running/csv_trajectory.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::lie {
class Integrator;
}

namespace hilda::studies {

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

/// Writes trajectory.csv and, on request, steps.csv, and collects the contents of checkpoints.
class Recorder {
public:
    struct Options {
        bool reactions = false, log_steps = false;
    };

    /// Creates the files in the directory. With a checkpoint, truncates them to the lengths stated there and
    /// restores the counters and the pivots of the integrator. io::IoError.
    Recorder(const dae::Model& model, lie::Integrator& integrator, const lie::TimeGrid& grid,
             const std::string& directory, const Options& options, const std::optional<Checkpoint>& from);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// The observers of the time integration. To be called directly before it starts.
    std::vector<lie::Observer*> observers();
    /// Counters of the whole run, including the part before the checkpoint
    lie::Statistics statistics() const;
    const Invariants& invariants() const { return trajectory.invariants; }

    /// Synchronises the files with the disk and returns a checkpoint of the current node. The caller sets the
    /// members `settings` and `wall_seconds`.
    Checkpoint checkpoint(const lie::March& march);
    /// Writes all buffered rows. io::IoError.
    void flush();

private:
    lie::Integrator& integrator;
    io::OutputFile trajectory_file;
    std::optional<io::OutputFile> steps_file;
    TrajectoryCsv trajectory;
    std::optional<StepsCsv> steps;
    PivotNode pivots;
    lie::Statistics earlier_statistics;  ///< of the part of the run before the checkpoint
};

}  // namespace hilda::studies
