// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include "contact/evolving/unilateral.hpp"
#include "contact/soft_friction.hpp"
#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "run/diagnosis.hpp"
#include "run/watch/run_check.hpp"

#include <ctime>

namespace hilda::run {

double thread_seconds()
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Simulation::Simulation(SimulationSetup setup)
    : model(setup.model), scheme(setup.scheme), times(setup.grid), settings(setup.settings),
      action(setup.watch)
{
    const double begin = thread_seconds();
    const bool of_caller = setup.integrator != nullptr;
    of_scheme = of_caller ? std::move(setup.integrator) : contact::make_integrator(model, scheme, settings);
    collect_warnings(setup);
    if (setup.event_table != nullptr && setup.description != nullptr && !setup.description->events.empty())
        make_events(*setup.description, *setup.event_table, of_caller);
    checks.emplace(model, setup.start, *of_scheme, scheme, times, action, setup.accept_unstable);
    progress.emplace(setup.start, *of_scheme, times.h);
    setup_seconds = thread_seconds() - begin;
}

void Simulation::collect_warnings(const SimulationSetup& setup)
{
    const auto add = [this](const char* name, std::vector<std::string> texts) {
        for (std::string& text : texts) found.push_back({name, std::move(text)});
    };
    if (setup.end > 0) add("grid", grid_warnings(times, setup.end, setup.interval, scheme));
    if (setup.description != nullptr) add("model", setup.description->warnings);
    add("soft_friction", contact::soft_friction_warnings(model, setup.start));
    for (const std::string& row : setup.dropped_rows)
        add("dropped_row", {row + ": redundant with the constraints before it, dropped from the equations"});
    if (std::string unstable = check_run(model, setup.start, scheme, times, setup.accept_unstable);
        !unstable.empty())
        add("unstable_step", {std::move(unstable)});
}

void Simulation::make_events(const dae::Description& description, RunTables& table, bool of_caller)
{
    if (const std::string why =
            of_caller ? "events need an integrator of the library" : why_no_events(scheme, *of_scheme);
        !why.empty())
        throw io::UsageError("run: " + description.events.front().value->name_place + ": " + why);
    const auto make = [this] { return contact::make_integrator(model, scheme, settings); };
    events_of_model = std::make_unique<RunEvents>(description, make, table);
}

void Simulation::resume(const lie::State& node, long number, int iterations)
{
    progress.emplace(node, *of_scheme, times.h, number, iterations);
}

void Simulation::list_observers()
{
    all.clear();
    if (events_of_model) all.push_back(events_of_model.get());
    all.push_back(&last);
    all.insert(all.end(), observers.begin(), observers.end());
    all.push_back(&*checks);
    all.insert(all.end(), checked.begin(), checked.end());
}

void Simulation::step()
{
    if (all.size() != observers.size() + checked.size() + (events_of_model ? 3 : 2)) list_observers();
    progress->advance(all);
}

Outcome Simulation::run(StepLoop* loop)
{
    list_observers();
    Outcome outcome;
    outcome.setup_seconds = setup_seconds;
    const double begin = thread_seconds();
    const auto count = [&] {  // before the additional step of finish(), which is not a step of the run
        if (outcome.step_seconds > 0) return;
        outcome.statistics = of_scheme->statistics();
        outcome.t = progress->node().t;
        outcome.step_seconds = thread_seconds() - begin;
    };
    using Next = StepLoop::Next;
    Next next = Next::step;
    try {
        try {
            while (progress->number() < times.steps) {
                if (loop != nullptr) next = loop->before_step(*progress);
                if (next != Next::step) break;
                progress->advance(all);
                if (loop != nullptr) loop->after_step(*progress);
            }
        } catch (const lie::Interrupted&) {  // during a step; the current node is unchanged
            next = Next::interrupt;
        }
        count();
        if (next == Next::interrupt) {
            outcome.status = "interrupted";
            return outcome;
        }
        if (next == Next::stop) outcome.status = "stopped";
        if (loop != nullptr && next == Next::step) loop->before_finish(*progress);
        progress->finish(all);
    } catch (const StoppedByEvent& event) {
        count();
        ended_at(event, outcome);
    } catch (const io::NumericalFailure& failure) {
        count();
        // The start node of the failed step is the last valid node, and may be an output row. The status
        // stays that of the step if a check of this node fails as well. The run is complete if it ends at an
        // event before this node.
        if (action != Watch::Action::record && last.number != progress->number()) try {
                progress->finish(all);
            } catch (const StoppedByEvent& event) {
                ended_at(event, outcome);
                return outcome;
            } catch (const io::NumericalFailure&) {
            }
        failed(failure, outcome);
    }
    return outcome;
}

/// The state at the event is the last node that the observers receive.
void Simulation::ended_at(const StoppedByEvent& event, Outcome& outcome)
{
    outcome.status = "stopped";
    outcome.stopped_by = event.event;
    outcome.t = event.x.t;
    times.steps = progress->number();
    try {
        for (lie::Observer* observer : observers)
            observer->accepted(event.x, progress->number(), progress->iterations_of_last_step());
    } catch (const lie::NodeFailure& failure) {
        failed(failure, outcome);
    }
}

void Simulation::failed(const io::NumericalFailure& failure, Outcome& outcome)
{
    outcome.status = failure.status;
    outcome.cause = failure.what();
    if (action == Watch::Action::record) return;  // no evaluation of the model in a study
    const Diagnosis d = diagnose(failure, model, progress->node(), progress->number(), times.h, scheme);
    outcome.message = d.what, outcome.detail = d.detail;
}

std::vector<Finding> Simulation::all_findings() const
{
    std::vector<Finding> list;
    for (const Finding& warning : found)
        if (warning.name == "soft_friction") list.push_back(warning);
    for (Finding& of_run : findings()) list.push_back(std::move(of_run));
    return list;
}

std::vector<Finding> Simulation::findings() const
{
    std::vector<Finding> all_findings = checks->findings();
    if (std::string rank = rank_warning(*of_scheme); !rank.empty())
        all_findings.push_back({"nearly_dependent", std::move(rank)});
    return all_findings;
}

}  // namespace hilda::run
