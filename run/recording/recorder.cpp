// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/recorder.hpp"

#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"

#include <utility>

namespace hilda::run {

Recorder::Recorder(const RunSetup& run, const lie::Integrator& integrator)
    : model(run.model), grid(run.grid), integrator(integrator), sinks(run), contacts(evolving_contacts(model))
{
    invariants.contact.resize(contacts.size());
}

void Recorder::open(const std::optional<Checkpoint>& from)
{
    if (from) {
        invariants = from->invariants;
        last = from->last_step;
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

Checkpoint Recorder::checkpoint(SimulationRecord of_simulation)
{
    sinks.sync();
    Checkpoint c;
    static_cast<SimulationRecord&>(c) = std::move(of_simulation);
    c.invariants = invariants;
    c.last_step = last;
    c.sinks = sinks.save();
    return c;
}

}  // namespace hilda::run
