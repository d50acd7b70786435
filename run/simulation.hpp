// SPDX-License-Identifier: GPL-3.0-or-later
/// One simulation: a march in time with the checks before it, the watch over its nodes, its events, and the
/// diagnosis of a failure.
///
/// lie::march() integrates without any of these, for the development of methods.
///
///     dae::start(model, x);
///     run::Simulation simulation(
///         {.model = model, .start = x, .scheme = lie::scheme("rA-half-1"), .grid = grid});
///     simulation.observe(my_observer);
///     const run::Outcome outcome = simulation.run();

#pragma once

#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "run/events/run_events.hpp"
#include "run/watch/watch.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hilda::run {

struct SimulationSetup {
    const dae::Model& model;
    const lie::State& start;  ///< consistent: see dae::start()
    const lie::Scheme& scheme;
    lie::TimeGrid grid;  ///< see time_grid()
    lie::Settings settings = {};
    Watch::Action watch = Watch::Action::stop;
    bool accept_unstable = false;  ///< a step above the stability limit gives a warning
    /// Ends and rows as they were asked for [s]; 0: those of the grid. A warning says if the grid has others.
    double end = 0, interval = 0;
    std::vector<std::string> dropped_rows = {};     ///< of dae::StartReport: a warning for each
    const dae::Description* description = nullptr;  ///< of a model file: its warnings and its events
    /// Takes the table of the events of the description, and outlives the simulation; nullptr: the simulation
    /// does not look for events
    RunTables* event_table = nullptr;
    /// Instead of the one that the scheme makes; nullptr: none. There are no events with it.
    std::unique_ptr<lie::Integrator> integrator = nullptr;
    /// Called with each of the warnings() when it is found, also before a refusal
    std::function<void(const Finding&)> warn = nullptr;
};

/// How a simulation ended
struct Outcome {
    /// ok; stopped: by an event, or because the caller stopped it; interrupted; otherwise that of the failure
    std::string status = "ok";
    /// Of a failure: time, step, scheme, and cause. With Watch::Action::record the cause alone
    std::string message;
    std::string detail;      ///< of a failure: constraint, force or contact; may be empty
    std::string cause;       ///< of a failure: what the scheme or the check reports, without time and step
    std::string stopped_by;  ///< name of the event that ended the run
    double t = 0;            ///< of the last complete node, or of the event [s]
    lie::Statistics statistics = {};  ///< of the steps up to the last node
    /// CPU time of this thread [s], of the construction and of the steps
    double setup_seconds = 0, step_seconds = 0;

    bool failed() const { return status != "ok" && status != "stopped" && status != "interrupted"; }
    /// Throws lie::Interrupted or io::NumericalFailure, with the cause, if the run did not reach its end.
    void throw_failure() const;
};

/// What a caller does between the steps of a simulation
class StepLoop {
public:
    enum class Next {
        step,
        stop,      ///< the current node is the last one, and is passed to the observers
        interrupt  ///< the current node is kept for a resumed run, and is not passed to them
    };

    virtual ~StepLoop() = default;
    /// Before each step
    virtual Next before_step(lie::March& march) = 0;
    /// After each step
    virtual void after_step(const lie::March& /*march*/) {}
    /// After the last step, before the observers receive its node
    virtual void before_finish(const lie::March& /*march*/) {}
};

class Simulation {
public:
    /// Makes the integrator and checks, in this order: end and rows, warnings of the model, friction that is
    /// too soft, rows that were dropped, prescribed motions and stability, whether the scheme can have the
    /// events of the model. The setup is moved from.
    ///
    /// Throws io::UsageError for a run that cannot be correct (check_run(), why_no_events()), and
    /// lie::InvalidInput if the scheme does not support the model. Model, description and scheme must outlive
    /// the simulation.
    explicit Simulation(SimulationSetup setup);
    Simulation(const Simulation&) = delete;

    /// What the checks found without refusing the run. The names are grid, model, soft_friction, dropped_row
    /// and unstable_step.
    const std::vector<Finding>& warnings() const { return found; }

    /// Adds an observer, after the events and before the watch: it also receives a node at which the watch
    /// ends the run, and the state of an event that ends it.
    void observe(lie::Observer& observer) { observers.push_back(&observer), all.clear(); }
    /// Adds an observer of the nodes that passed the watch.
    void observe_checked(lie::Observer& observer) { checked.push_back(&observer), all.clear(); }

    /// Continues a run at this node, before run() or step(). The caller restores the watch, the pivots and
    /// the contact events of the integrator, and opens events(): see Recorder::open().
    void resume(const lie::State& node, long number, int iterations);

    /// Computes the steps that are left, and passes the nodes to the observers, each once. After an
    /// interruption it can be called again; after another end it returns the same outcome.
    ///
    /// Exceptions other than io::NumericalFailure, lie::Interrupted and StoppedByEvent, of observers or of
    /// user code in the model, are thrown on. outcome() then has what was known before. With
    /// Watch::Action::record the node at the start of a failed step is not passed to the observers.
    const Outcome& run(StepLoop* loop = nullptr);
    /// Computes one step. Returns false, without a step, at the end of the grid or after an event that ends
    /// the run. Throws as lie::March::advance(). run() then computes the steps that are left, and passes the
    /// last node.
    bool step();
    const Outcome& outcome() const { return result; }

    const lie::State& state() const { return progress->node(); }
    long number() const { return progress->number(); }
    /// The grid; after an event that ends the run its end is there
    const lie::TimeGrid& grid() const { return grid_of_run; }
    lie::Integrator& integrator() { return *stepper; }
    Watch& watch() { return *watch_of_run; }
    RunEvents* events() { return events_of_model.get(); }  ///< nullptr if the run has none
    const lie::March& march() const { return *progress; }
    /// Findings of the watch, and constraints that nearly lost rank
    std::vector<Finding> findings() const;
    /// Friction that is too soft, and findings(): what may make the solution wrong
    std::vector<Finding> findings_of_solution() const;

private:
    void collect_warnings(const SimulationSetup& setup);
    /// of_caller: the integrator is not that of the scheme
    void make_events(const dae::Description& description, RunTables& table, bool of_caller);
    void begin();
    void count();
    void march_to_end(StepLoop* loop);
    void ended_at(const StoppedByEvent& event);
    void failed(const io::NumericalFailure& failure);
    void report(const io::NumericalFailure& failure);

    const dae::Model& model;
    const lie::Scheme& scheme;
    lie::TimeGrid grid_of_run;
    const lie::Settings settings;
    const Watch::Action action;
    std::unique_ptr<lie::Integrator> stepper;
    std::vector<Finding> found;
    std::unique_ptr<RunEvents> events_of_model;
    std::optional<Watch> watch_of_run;
    std::optional<lie::March> progress;
    std::vector<lie::Observer*> observers, checked;
    std::vector<lie::Observer*> all;  ///< in the order of their calls; empty: to be listed by begin()
    Outcome result;
    bool counted = false, ended = false;
    double begin_seconds = 0;  ///< CPU time of the thread when run() was called
    /// Number of the last node that the observers received
    class Last final : public lie::Observer {
    public:
        void accepted(const lie::State& /*node*/, long n, int /*iterations*/) override { number = n; }
        long number = -1;
    } last;
};

/// CPU time of the calling thread [s]
double thread_seconds();

}  // namespace hilda::run
