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
    : model(setup.model), scheme(setup.scheme), grid_of_run(setup.grid), settings(setup.settings),
      action(setup.watch)
{
    const double begin = thread_seconds();
    const bool of_caller = setup.integrator != nullptr;
    stepper = of_caller ? std::move(setup.integrator) : contact::make_integrator(model, scheme, settings);
    collect_warnings(setup);
    if (setup.event_table != nullptr && setup.description != nullptr && !setup.description->events.empty())
        make_events(*setup.description, *setup.event_table, of_caller);
    watch_of_run.emplace(model, setup.start, *stepper, scheme, grid_of_run, action, setup.accept_unstable);
    progress.emplace(setup.start, *stepper, grid_of_run.h);
    result.setup_seconds = thread_seconds() - begin;
}

void Simulation::collect_warnings(const SimulationSetup& setup)
{
    const auto add = [&](const char* name, std::vector<std::string> texts) {
        for (std::string& text : texts) {
            found.push_back({name, std::move(text)});
            if (setup.warn) setup.warn(found.back());
        }
    };
    if (setup.end > 0) add("grid", grid_warnings(grid_of_run, setup.end, setup.interval, scheme));
    if (setup.description != nullptr) add("model", setup.description->warnings);
    add("soft_friction", contact::soft_friction_warnings(model, setup.start));
    for (const std::string& row : setup.dropped_rows)
        add("dropped_row", {row + ": redundant with the constraints before it, dropped from the equations"});
    if (std::string unstable = check_run(model, setup.start, scheme, grid_of_run, setup.accept_unstable);
        !unstable.empty())
        add("unstable_step", {std::move(unstable)});
}

void Simulation::make_events(const dae::Description& description, RunTables& table, bool of_caller)
{
    if (const std::string why =
            of_caller ? "events need an integrator of the library" : why_no_events(scheme, *stepper);
        !why.empty())
        throw io::UsageError("run: " + description.events.front().value->name_place + ": " + why);
    const auto make = [this] { return contact::make_integrator(model, scheme, settings); };
    events_of_model = std::make_unique<RunEvents>(description, make, table);
}

void Simulation::resume(const lie::State& node, long number, int iterations)
{
    progress.emplace(node, *stepper, grid_of_run.h, number, iterations);
    last.number = -1;
}

/// Lists the observers, and opens the table of events if the caller has not.
void Simulation::begin()
{
    all.clear();
    if (events_of_model) all.push_back(events_of_model.get());
    all.push_back(&last);
    all.insert(all.end(), observers.begin(), observers.end());
    all.push_back(&*watch_of_run);
    all.insert(all.end(), checked.begin(), checked.end());
    if (events_of_model && !events_of_model->is_open()) events_of_model->open("", "");
}

bool Simulation::step()
{
    if (ended || progress->number() >= grid_of_run.steps) return false;
    if (all.empty()) begin();
    try {
        progress->advance(all);
    } catch (const StoppedByEvent& event) {
        counted = false, begin_seconds = thread_seconds();
        count();
        ended_at(event);
        return false;
    }
    return true;
}

/// Counters and times up to the current node. The additional step of finish() is not a step of the run.
void Simulation::count()
{
    if (counted) return;
    counted = true;
    result.statistics = stepper->statistics();
    result.t = progress->node().t;
    result.step_seconds += thread_seconds() - begin_seconds;
}

const Outcome& Simulation::run(StepLoop* loop)
{
    if (ended) return result;
    begin();
    result.status = "ok";
    counted = false, begin_seconds = thread_seconds();
    try {
        march_to_end(loop);
    } catch (const StoppedByEvent& event) {
        count();
        ended_at(event);
    } catch (const lie::Interrupted&) {  // during a step; the current node is unchanged
        count();
        result.status = "interrupted";
    } catch (const io::NumericalFailure& failure) {
        count();
        failed(failure);
    } catch (...) {
        count();
        throw;
    }
    ended = result.status != "interrupted";
    return result;
}

void Simulation::march_to_end(StepLoop* loop)
{
    using Next = StepLoop::Next;
    Next next = Next::step;
    while (progress->number() < grid_of_run.steps) {
        if (loop != nullptr) next = loop->before_step(*progress);
        if (next != Next::step) break;
        progress->advance(all);
        if (loop != nullptr) loop->after_step(*progress);
    }
    count();
    if (next == Next::interrupt) {
        result.status = "interrupted";
        return;
    }
    if (next == Next::stop) result.status = "stopped";
    if (loop != nullptr && next == Next::step) loop->before_finish(*progress);
    progress->finish(all);
}

/// The state at the event is the last node that the observers receive.
void Simulation::ended_at(const StoppedByEvent& event)
{
    ended = true;
    result.status = "stopped";
    result.stopped_by = event.event;
    result.t = event.x.t;
    grid_of_run.steps = progress->number();
    try {
        for (lie::Observer* observer : observers)
            observer->accepted(event.x, progress->number(), progress->iterations_of_last_step());
    } catch (const io::NumericalFailure& failure) {
        report(failure);
    }
}

void Simulation::failed(const io::NumericalFailure& failure)
{
    ended = true;
    report(failure);
    if (action == Watch::Action::record || last.number == progress->number()) return;
    // The start node of the failed step is the last valid node, and may be an output row. The status stays
    // that of the step if a check of this node fails as well. The run is complete if it ends at an event
    // before this node.
    try {
        progress->finish(all);
    } catch (const StoppedByEvent& event) {
        result.cause.clear(), result.message.clear(), result.detail.clear();
        ended_at(event);
    } catch (const io::NumericalFailure&) {
    }
}

void Simulation::report(const io::NumericalFailure& failure)
{
    result.status = failure.status;
    result.cause = result.message = failure.what();
    if (action == Watch::Action::record) return;
    const Diagnosis d = diagnose(failure, model, progress->node(), progress->number(), grid_of_run.h, scheme);
    result.message = d.what, result.detail = d.detail;
}

void Outcome::throw_failure() const
{
    if (status == "interrupted") throw lie::Interrupted();
    if (failed()) throw io::NumericalFailure(status, cause);
}

std::vector<Finding> Simulation::findings_of_solution() const
{
    std::vector<Finding> list;
    for (const Finding& warning : found)
        if (warning.name == "soft_friction") list.push_back(warning);
    for (Finding& of_run : findings()) list.push_back(std::move(of_run));
    return list;
}

std::vector<Finding> Simulation::findings() const
{
    std::vector<Finding> list = watch_of_run->findings();
    if (std::string rank = rank_warning(*stepper); !rank.empty())
        list.push_back({"nearly_dependent", std::move(rank)});
    return list;
}

}  // namespace hilda::run
