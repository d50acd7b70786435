// SPDX-License-Identifier: GPL-3.0-or-later
/// The files of a run while it marches, and what a checkpoint needs of them.

#pragma once

#include "studies/running/checkpoint.hpp"
#include "studies/running/csv_steps.hpp"
#include "studies/running/csv_trajectory.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

/// Where the integrator last chose pivots: the state, or, of a scheme that does not tell it, the node before
/// the step in which it did. A new integrator brought there has the pivots of the old one and gives the same
/// digits from then on: pivots are all that an integrator remembers outside the state.
class PivotNode final : public lie::Observer {
public:
    explicit PivotNode(lie::Integrator& integrator) : integrator(integrator) {}

    void accepted(const lie::State& x, long n, int iterations) override;
    /// Brings a new integrator to the pivots that another got there.
    void restore(const lie::State& from, double h);

    lie::State node;

private:
    lie::Integrator& integrator;
    long seen = 0;
};

class Recorder {
public:
    struct Options {
        bool reactions = false, log_steps = false;
    };

    /// Begins the files in the directory, or goes on with them, and with the counts, where the checkpoint
    /// left them.
    Recorder(const dae::Model& model, lie::Integrator& integrator, const lie::TimeGrid& grid,
             const std::string& directory, const Options& options, const std::optional<Checkpoint>& from);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// To be called just before the march sets off
    std::vector<lie::Observer*> observers();
    /// Of the whole run, also before the checkpoint
    lie::Statistics statistics() const;
    const Invariants& invariants() const { return trajectory.invariants; }

    /// Brings the files to the disk, then says how to go on from there; the settings are left to the caller.
    Checkpoint checkpoint(const lie::March& march);
    void flush();

private:
    lie::Integrator& integrator;
    OutputFile trajectory_file;
    std::optional<OutputFile> steps_file;
    TrajectoryCsv trajectory;
    std::optional<StepsCsv> steps;
    PivotNode pivots;
    lie::Statistics before;  ///< what the integrator did not count itself
};

}  // namespace hilda::studies
