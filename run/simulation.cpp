// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include "contact/evolving/unilateral.hpp"
#include "contact/soft_friction.hpp"
#include "dae/start.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "run/diagnosis.hpp"
#include "run/watch/rigid_contact_findings.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
      action(setup.watch), before_step(std::move(setup.before_step))
{
    const double begin = thread_seconds();
    const bool of_caller = setup.integrator != nullptr;
    stepper = of_caller ? std::move(setup.integrator) : contact::make_integrator(model, scheme, settings);
    collect_warnings(setup);
    if (setup.event_table != nullptr && setup.description != nullptr && !setup.description->events.empty())
        make_events(*setup.description, *setup.event_table, of_caller);
    watch_of_run.emplace(model, setup.start, *stepper, scheme, grid_of_run, action, setup.accept_unstable);
    pivots.emplace(*stepper);
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

Simulation::~Simulation() = default;

void Simulation::make_events(const dae::Description& description, RunTables& table, bool of_caller)
{
    if (const std::string why =
            of_caller ? "events need an integrator of the library" : why_no_events(scheme, *stepper);
        !why.empty())
        throw io::UsageError("run: " + description.events.front().value->name_place + ": " + why);
    const auto make = [this] { return contact::make_integrator(model, scheme, settings); };
    events_of_model = std::make_unique<RunEvents>(description, make, table);
}

void Simulation::resume(const SimulationRecord& from, const std::string& file)
{
    watch_of_run->restore(from.watch);
    restore(*stepper, *pivots, from);
    earlier = from.statistics;
    earlier.add_counts(stepper->statistics(), -1);
    progress.emplace(from.node, *stepper, grid_of_run.h, from.number, from.iterations);
    if (events_of_model) events_of_model->open(from.events, file);
    last.number = -1;
}

/// Restores what the integrator stores in addition to the state.
void Simulation::restore(lie::Integrator& integrator, PivotNode& of_integrator,
                         const SimulationRecord& from) const
{
    of_integrator.restore(from.pivots, grid_of_run.h);
    if (auto* unilateral = dynamic_cast<contact::UnilateralStep*>(&integrator))
        unilateral->restore(from.contacts);
}

SimulationRecord Simulation::record()
{
    open_events();
    SimulationRecord r = record_of_integrator();
    r.watch = watch_of_run->record();
    if (events_of_model) r.events = events_of_model->save();
    return r;
}

SimulationRecord Simulation::record_of_integrator() const
{
    SimulationRecord r;
    r.node = progress->node();
    r.number = progress->number();
    r.iterations = progress->iterations_of_last_step();
    r.pivots = pivots->node;
    r.statistics = statistics();
    if (const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(stepper.get()))
        r.contacts = unilateral->history();
    return r;
}

void Simulation::transfer(io::Archive& a)
{
    SimulationRecord r;
    if (!a.reads()) r = record();
    run::transfer(a, r);
    if (!a.reads()) return;
    check_fits(r, model, progress->node(), a.name());
    resume(r, a.name());
}

void Simulation::set_loads(const lie::Loads& loads)
{
    if (ended) refuse("loads cannot be set: the run has ended");
    if (!scheme.resumes)
        refuse(scheme.name +
               " stores past steps outside the state; loads between steps need another integrator");
    const auto bodies = static_cast<size_t>(model.bodies());
    if (loads.F.size() != bodies || loads.n_bar.size() != bodies)
        lie::reject("run", "the loads F and n_bar need a vector for each body, F has",
                    static_cast<double>(loads.F.size()));
    std::vector<double> numbers;
    for (size_t b = 0; b < bodies; ++b)
        for (const lie::Vec3* load : {&loads.F[b], &loads.n_bar[b]}) {
            if (!load->allFinite())
                throw lie::InvalidInput(fmt::format("run: the loads on body '{}' are not finite",
                                                    model.body_name(static_cast<int>(b))));
            numbers.insert(numbers.end(), load->begin(), load->end());
        }
    const std::vector<double>& before = progress->node().applied_loads;
    if (before.empty() && std::all_of(numbers.begin(), numbers.end(), [](double v) { return v == 0; }))
        return;
    if (numbers != before) apply(numbers);
}

void Simulation::apply(const std::vector<double>& loads)
{
    lie::State x = progress->node();
    x.applied_loads = loads;
    if (progress->number() == 0) {
        dae::set_start_accelerations(model, x);
    } else if (!stepper->is_staggered() && model.bounded_pairs().empty()) {
        if (!saddle) saddle = std::make_unique<lie::Saddle>(model);
        // New pivots: the digits must not depend on the nodes before.
        saddle->choose_pivots(x);
        lie::solve_accelerations(model, *saddle, x);
    }
    // The solution has a kink here. The internal steps of an adaptive scheme end beyond the node.
    if (stepper->chooses_internal_steps()) x.history.resize(0);
    progress->set_node(x);
}

lie::State Simulation::complete_node() const
{
    if (at_event || !stepper->is_staggered() || progress->number() == 0) return state();
    class Copy final : public lie::Observer {
    public:
        void accepted(const lie::State& node, long /*n*/, int /*iterations*/) override { x = node; }
        lie::State x;
    } copy;
    if (!completing) completing = contact::make_integrator(model, scheme, settings);
    PivotNode of_integrator(*completing);
    restore(*completing, of_integrator, record_of_integrator());
    lie::Observer* observers[] = {&copy};
    lie::March(progress->node(), *completing, grid_of_run.h, progress->number()).finish(observers);
    return copy.x;
}

void Simulation::refuse(const std::string& why) const { throw io::UsageError("run: " + why); }

void Simulation::open_events()
{
    if (events_of_model && !events_of_model->is_open()) events_of_model->open("", "");
}

/// Lists the observers, and opens the table of events if the caller has not.
void Simulation::begin()
{
    all.clear();
    if (events_of_model) all.push_back(events_of_model.get());
    all.push_back(&last);
    all.push_back(&*pivots);
    all.insert(all.end(), observers.begin(), observers.end());
    all.push_back(&*watch_of_run);
    all.insert(all.end(), checked.begin(), checked.end());
    open_events();
}

void Simulation::advance()
{
    if (before_step) before_step(*progress);
    progress->advance(all);
}

bool Simulation::step()
{
    if (result.failed())
        refuse(fmt::format("the simulation has failed at t = {:.6g} s ({}); it cannot continue", result.t,
                           result.status));
    if (ended || progress->number() >= grid_of_run.steps) return false;
    if (all.empty()) begin();
    result.status = "ok";
    try {
        advance();
        return true;
    } catch (const lie::Interrupted&) {  // the current node is unchanged
        throw;
    } catch (const StoppedByEvent& event) {
        count_step();
        ended_at(event);
    } catch (const io::NumericalFailure& failure) {
        count_step();
        failed(failure);
    }
    if (result.failed()) throw io::NumericalFailure(result.status, result.text());
    return false;
}

lie::Statistics Simulation::statistics() const
{
    lie::Statistics sum = stepper->statistics();
    sum.add(earlier);
    return sum;
}

/// Counters and times up to the current node. The additional step of finish() is not a step of the run.
void Simulation::count()
{
    if (counted) return;
    counted = true;
    result.statistics = statistics();
    result.t = progress->node().t;
    result.step_seconds += thread_seconds() - begin_seconds;
}

/// The same after a step() that ends the run. The time of single steps is not measured.
void Simulation::count_step()
{
    counted = false, begin_seconds = thread_seconds();
    count();
}

const Outcome& Simulation::run(const std::function<Next()>& next)
{
    if (ended) return result;
    begin();
    result.status = "ok";
    counted = false, begin_seconds = thread_seconds();
    try {
        march_to_end(next);
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

void Simulation::march_to_end(const std::function<Next()>& next)
{
    Next now = Next::step;
    while (progress->number() < grid_of_run.steps) {
        if (next) now = next();
        if (now != Next::step) break;
        advance();
    }
    count();
    if (now == Next::interrupt) {
        result.status = "interrupted";
        return;
    }
    if (now == Next::stop) result.status = "stopped";
    progress->finish(all);
}

/// The state at the event is the last node that the observers receive.
void Simulation::ended_at(const StoppedByEvent& event)
{
    ended = true;
    result.status = "stopped";
    result.stopped_by = event.event;
    result.t = event.x.t;
    at_event = event.x;
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
    if (!model.rigid_contacts().empty())
        for (Finding& of_contacts : rigid_contact_findings(statistics()))
            list.push_back(std::move(of_contacts));
    return list;
}

}  // namespace hilda::run
