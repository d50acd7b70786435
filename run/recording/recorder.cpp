// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/recorder.hpp"

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"

namespace hilda::run {

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

Recorder::Recorder(const RunSetup& run, lie::Integrator& integrator, Watch& watch)
    : model(run.model), grid(run.grid), integrator(integrator), watch(watch), sinks(run),
      contacts(evolving_contacts(model)), pivots(integrator)
{
    invariants.contact.resize(contacts.size());
}

void Recorder::open(const std::optional<Checkpoint>& from)
{
    if (from) {
        invariants = from->invariants;
        watch.restore(from->watch);
        last = from->last_step;
        pivots.restore(from->pivots, grid.h);
        if (auto* unilateral = dynamic_cast<contact::UnilateralStep*>(&integrator))
            unilateral->restore(from->contacts);
        earlier_statistics = sum(from->statistics, integrator.statistics(), -1);
        sinks.open(from->sinks, "checkpoint");
    } else {
        sinks.open();
    }
    factorizations = integrator.statistics().factorizations;
    since = Clock::now();
}

void Recorder::accepted(const lie::State& x, long n, int iterations)
{
    const Clock::time_point now = Clock::now();
    const double energy = lie::energy(model, x), constraint_norm = model.largest_residual(x).value;
    invariants.update(model, contacts, x, energy, constraint_norm);
    const bool is_row = grid.is_row(n);
    if (is_row) ++invariants.rows;
    sinks.node(n, {.x = x,
                   .n = n,
                   .is_row = is_row,
                   .energy = energy,
                   .constraint_norm = constraint_norm,
                   .iterations = iterations,
                   .cost = last});
    dae::check_dropped_rows(model, x);
    // lie::March reports a node after the following step; the counters since the last call are those of that
    // step.
    const lie::Statistics counted = integrator.statistics();
    last = {counted.factorizations - factorizations, std::chrono::nanoseconds(now - since).count(),
            counted.correction};
    factorizations = counted.factorizations;
    since = Clock::now();
}

lie::Statistics Recorder::statistics(const lie::Statistics& of_this_part) const
{
    return sum(earlier_statistics, of_this_part, 1);
}

Checkpoint Recorder::checkpoint(const lie::March& march)
{
    sinks.sync();
    Checkpoint c;
    c.node = march.node();
    c.number = march.number();
    c.iterations = march.iterations_of_last_step();
    c.pivots = pivots.node;
    c.statistics = statistics(integrator.statistics());
    c.invariants = invariants;
    c.watch = watch.record();
    if (const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(&integrator))
        c.contacts = unilateral->history();
    c.last_step = last;
    c.sinks = sinks.save();
    return c;
}

}  // namespace hilda::run
