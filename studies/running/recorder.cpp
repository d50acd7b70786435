// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/recorder.hpp"

#include "dae/model.hpp"

namespace hilda::studies {

namespace {

lie::Statistics sum(const lie::Statistics& a, const lie::Statistics& b, long sign)
{
    return {a.steps + sign * b.steps, a.iterations + sign * b.iterations,
            a.factorizations + sign * b.factorizations, a.refactorizations + sign * b.refactorizations};
}

}  // namespace

void PivotNode::accepted(const lie::State& x, long, int)
{
    const long factorizations = integrator.statistics().factorizations;
    if (factorizations == last_count) return;
    last_count = factorizations;
    node = integrator.pivots() != nullptr ? *integrator.pivots() : x;
}

void PivotNode::restore(const lie::State& from, double h)
{
    node = from;
    if (node.body.empty()) return;
    try {
        if (integrator.pivots() != nullptr) {
            integrator.choose_pivots(node, h);
        } else {
            lie::State discarded = node;
            integrator.step(discarded, h);
        }
    } catch (const lie::NumericalFailure&) {
        // The pivots are chosen before the step can fail, and only they are needed.
    }
    last_count = integrator.statistics().factorizations;
}

Recorder::Recorder(const dae::Model& model, lie::Integrator& integrator, const lie::TimeGrid& grid,
                   const std::string& directory, const Options& options,
                   const std::optional<Checkpoint>& from)
    : integrator(integrator),
      trajectory_file(directory + "/trajectory.csv", from ? from->trajectory_bytes : 0, from.has_value()),
      trajectory(model, grid, trajectory_file, options.reactions), pivots(integrator)
{
    if (options.log_steps) {
        steps_file.emplace(directory + "/steps.csv", from ? from->steps_bytes : 0, from.has_value());
        steps.emplace(model, integrator, grid.h, *steps_file);
    }
    if (from) {
        trajectory.invariants = from->invariants;
        if (steps) steps->last = from->last_step;
        pivots.restore(from->pivots, grid.h);
        if (auto* unilateral = dynamic_cast<contact::UnilateralStep*>(&integrator))
            unilateral->restore(from->contacts);
        earlier_statistics = sum(from->statistics, integrator.statistics(), -1);
    } else {
        trajectory.write_header();
        if (steps) steps->write_header();
    }
}

std::vector<lie::Observer*> Recorder::observers()
{
    std::vector<lie::Observer*> all = {&trajectory, &pivots};
    if (steps) {
        steps->begin();
        all.push_back(&*steps);
    }
    return all;
}

lie::Statistics Recorder::statistics() const { return sum(earlier_statistics, integrator.statistics(), 1); }

Checkpoint Recorder::checkpoint(const lie::March& march)
{
    trajectory_file.sync();
    if (steps) steps_file->sync();
    Checkpoint c;
    c.node = march.node();
    c.number = march.number();
    c.iterations = march.iterations_of_last_step();
    c.pivots = pivots.node;
    c.statistics = statistics();
    c.invariants = invariants();
    if (const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(&integrator))
        c.contacts = unilateral->history();
    c.trajectory_bytes = trajectory_file.size();
    if (steps) {
        c.last_step = steps->last;
        c.steps_bytes = steps_file->size();
    }
    return c;
}

void Recorder::flush()
{
    trajectory_file.flush();
    if (steps) steps_file->flush();
}

}  // namespace hilda::studies
