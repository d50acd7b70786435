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
#include "run/recording/pivot_node.hpp"
#include "run/recording/simulation_record.hpp"
#include "run/watch/watch.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hilda::lie {
class Saddle;
}

namespace hilda::run {

struct SimulationSetup {
    const dae::Model& model;
    const lie::State& start;  ///< consistent: see dae::start()
    const lie::Scheme& scheme;
    lie::TimeGrid grid;  ///< see time_grid()
    lie::Settings settings = {};
    Watch::Action watch = Watch::Action::stop;
    bool accept_unstable = false;  ///< a step above the stability limit gives a warning
    /// End and interval that were requested [s]; 0: those of the grid. A warning says if the grid has others.
    double end = 0, interval = 0;
    std::vector<std::string> dropped_rows = {};     ///< of dae::StartReport: a warning for each
    const dae::Description* description = nullptr;  ///< of a model file: its warnings and its events
    /// Takes the table of the events of the description, and outlives the simulation; nullptr: the simulation
    /// does not look for events
    RunTables* event_table = nullptr;
    /// Instead of the one that the scheme makes; nullptr: none. There are no events with it.
    std::unique_ptr<lie::Integrator> integrator = nullptr;
    /// Called before each step; a failure in it is one of the step
    std::function<void(lie::March&)> before_step = nullptr;
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
    lie::Statistics statistics = {};  ///< of all steps up to the last node, also of those before a resumption
    /// CPU time of this thread [s], of the construction and of the steps in run()
    double setup_seconds = 0, step_seconds = 0;

    bool failed() const { return status != "ok" && status != "stopped" && status != "interrupted"; }
    /// The message and the detail of a failure
    std::string text() const { return message + (detail.empty() ? "" : "; " + detail); }
    /// Throws lie::Interrupted or io::NumericalFailure, with the cause, if the run did not reach its end.
    void throw_failure() const;
};

class Simulation {
public:
    /// What run() does next
    enum class Next {
        step,
        stop,      ///< the current node is the last one, and is passed to the observers
        interrupt  ///< the current node is kept for a resumed run, and is not passed to them
    };

    /// Makes the integrator and checks, in this order: end and rows, warnings of the model, friction that is
    /// too soft, rows that were dropped, prescribed motions and stability, whether the scheme can have the
    /// events of the model. The setup is moved from.
    ///
    /// Throws io::UsageError for a run that cannot be correct (check_run(), why_no_events()), and
    /// lie::InvalidInput if the scheme does not support the model. Model, description and scheme must outlive
    /// the simulation.
    explicit Simulation(SimulationSetup setup);
    ~Simulation();
    Simulation(const Simulation&) = delete;

    /// What the checks found without refusing the run. The names are grid, model, soft_friction, dropped_row
    /// and unstable_step.
    const std::vector<Finding>& warnings() const { return found; }

    /// Adds an observer, after the events and before the watch: it also receives a node at which the watch
    /// ends the run, and the state of an event that ends it.
    void observe(lie::Observer& observer) { observers.push_back(&observer), all.clear(); }
    /// Adds an observer of the nodes that passed the watch.
    void observe_checked(lie::Observer& observer) { checked.push_back(&observer), all.clear(); }

    /// Continues a run from its record, before run() or step(). `file` is for messages. io::IoError.
    void resume(const SimulationRecord& from, const std::string& file);
    /// What a run that continues from the current node needs. Synchronises the table of events with the disk.
    SimulationRecord record();
    /// Writes record(), or reads a record of the same model, scheme, settings and step, and resumes.
    /// io::IoError if the record does not fit the model.
    void transfer(io::Archive& a);

    /// Sets loads that act in addition to those of the model, from the current node on until they are set
    /// again: State::applied_loads.
    ///
    /// At the start, and at each node of a scheme that is not staggered, the accelerations and multipliers of
    /// the node follow the loads; those of a model with regularised rows at the start only. A scheme with
    /// adaptive steps restarts at the node.
    ///
    /// Throws lie::InvalidInput if the loads are not finite or not those of the bodies, and io::UsageError if
    /// the run has ended, or for a scheme that stores past steps outside the state.
    void set_loads(const lie::Loads& loads);

    /// Computes the steps that are left, and passes the nodes to the observers, each once. `next` is called
    /// before each step. After an interruption run() can be called again; after another end it returns the
    /// same outcome.
    ///
    /// Exceptions other than io::NumericalFailure, lie::Interrupted and StoppedByEvent, of observers or of
    /// user code in the model, are thrown on. outcome() then has what was known before. With
    /// Watch::Action::record the node at the start of a failed step is not passed to the observers.
    const Outcome& run(const std::function<Next()>& next = nullptr);
    /// Computes one step. Returns false, without a step, at the end of the grid or after an event that ends
    /// the run. run() then computes the steps that are left, and passes the last node.
    ///
    /// A failure is recorded as by run(), and thrown as io::NumericalFailure with the message and the detail
    /// of the outcome. Then, a further call throws io::UsageError. lie::Interrupted and exceptions of user
    /// code leave the node unchanged.
    bool step();
    const Outcome& outcome() const { return result; }
    /// Whether the run is complete, was stopped, or has failed
    bool has_ended() const { return ended; }

    /// The current node, or the state of the event that ended the run. The accelerations and multipliers of a
    /// node of a staggered scheme (lie::Integrator::is_staggered()) are those of the step that ends there.
    const lie::State& state() const { return at_event ? *at_event : progress->node(); }
    /// The same state as an observer will receive it if the loads remain: velocities, accelerations and
    /// multipliers are those of its time. A staggered scheme computes an additional step with another
    /// integrator.
    lie::State complete_node() const;
    long number() const { return progress->number(); }
    /// The grid; after an event that ends the run its end is there
    const lie::TimeGrid& grid() const { return grid_of_run; }
    lie::Integrator& integrator() { return *stepper; }
    Watch& watch() { return *watch_of_run; }
    RunEvents* events() { return events_of_model.get(); }  ///< nullptr if the run has none
    /// Counters up to the current node, also of the steps before a resumption
    lie::Statistics statistics() const;
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
    void open_events();
    [[noreturn]] void refuse(const std::string& why) const;
    void apply(const std::vector<double>& loads);
    SimulationRecord record_of_integrator() const;
    void restore(lie::Integrator& integrator, PivotNode& pivots, const SimulationRecord& from) const;
    void count();
    void count_step();
    void advance();
    void march_to_end(const std::function<Next()>& next);
    void ended_at(const StoppedByEvent& event);
    void failed(const io::NumericalFailure& failure);
    void report(const io::NumericalFailure& failure);

    const dae::Model& model;
    const lie::Scheme& scheme;
    lie::TimeGrid grid_of_run;
    const lie::Settings settings;
    const Watch::Action action;
    const std::function<void(lie::March&)> before_step;
    std::unique_ptr<lie::Integrator> stepper;
    std::vector<Finding> found;
    std::unique_ptr<RunEvents> events_of_model;
    std::optional<Watch> watch_of_run;
    std::optional<PivotNode> pivots;
    lie::Statistics earlier;  ///< of the steps before a resumption, minus those of its preparation
    std::optional<lie::March> progress;
    std::optional<lie::State> at_event;                   ///< the last state, if an event ended the run
    std::unique_ptr<lie::Saddle> saddle;                  ///< for set_loads(), made when it is first needed
    mutable std::unique_ptr<lie::Integrator> completing;  ///< for complete_node(), the same
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
