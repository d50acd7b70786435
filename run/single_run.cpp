// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/single_run.hpp"

#include "io/files.hpp"
#include "io/message.hpp"
#include "io/option_values.hpp"
#include "lie/schemes.hpp"
#include "run/figures.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/coupling.hpp"
#include "run/tables/run_table.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace hilda::run {

namespace {

lie::Settings interruptible(lie::Settings settings)
{
    settings.stop = [] { return io::Interrupt::caught() != 0; };
    return settings;
}

}  // namespace

SingleRun::SingleRun(const RunOptions& options, const lie::Scheme& scheme, std::string directory)
    : Resumable({.directory = directory,
                 .checkpoint = options.checkpoint,
                 .resume = options.resume,
                 .quiet = options.quiet,
                 .verbose = options.verbose,
                 .force = options.force}),
      options(options), scheme(&scheme), directory(directory), earlier(std::move(directory))
{}

RunResult SingleRun::execute()
{
    Resumable::execute();
    return std::move(result);
}

bool SingleRun::read()
{
    description = named_model(options.model, options.set, options.normal_rows, options.allow_paths);
    if (options.chooses_integrator) scheme = &lie::scheme(default_integrator_of(*description.model));
    return true;
}

void SingleRun::restore(const std::string& bytes, const std::string& file) { earlier.read(bytes, file); }

void SingleRun::check()
{
    const std::optional<Checkpoint>& from = earlier.from;
    if (options.resume) earlier.require_checkpoint();
    if (options.coupling != nullptr) prepare_coupling();
    result.start = dae::start(description, {.fix_initial = options.fix_initial});
    result.end = options.end.value_or(from ? from->end : description.end);
    std::optional<double> interval = options.interval;
    if (!interval && from && scheme->adaptive)
        interval = io::number_in<double>(from->settings.at("--interval"));
    grid = time_grid(*scheme, result.end, options.step, interval);
    if (from && !options.interval && !scheme->adaptive) grid.interval = from->interval;
    log(fmt::format("{}: initial residuals {:.1e} in position, {:.1e} in velocity{}", description.name,
                    result.start.position_residual, result.start.velocity_residual,
                    result.start.projected ? ", projected" : ""));
    describe(result, options, *scheme, description, grid);
    result.directory = directory;
    const RunIdentity identity{options, *scheme, description, grid, result.end, text_of_model()};
    settings = earlier.settings(identity);
    if (from) earlier.check_continues(identity, settings);
    if (!description.events.empty()) refuse_events();
    make_simulation();
    result.setup_seconds = seconds();
}

void SingleRun::prepare_coupling()
{
    const std::optional<Checkpoint>& from = earlier.from;
    if (!from) {  // an invalid start is reported before the other side writes files
        dae::Description alone =
            named_model(options.model, options.set, options.normal_rows, options.allow_paths);
        dae::start(alone, {.fix_initial = options.fix_initial});
    }
    create_directory();
    options.coupling->prepare(description, from ? std::optional(from->number) : std::nullopt);
}

/// io::UsageError if a run with these options cannot have events
void SingleRun::refuse_events() const
{
    const auto refuse = [&](const std::string& why) {
        throw io::UsageError("run: " + description.events.front().value->name_place + ": " + why);
    };
    if (options.coupling != nullptr) refuse("a co-simulation has no events");
    if (options.error) refuse("--error is for models without events");
}

void SingleRun::make_simulation()
{
    tables = run_tables(options.outputs, directory,
                        {{"program", version_line()},
                         {"command_line", options.command_line},
                         {"integrator", scheme->name},
                         {"model", description.name},
                         {"model_text", text_of_model()}});
    const lie::Settings of_integrator = interruptible(options.settings);
    using Action = Watch::Action;
    SimulationSetup setup{.model = *description.model,
                          .start = description.x,
                          .scheme = *scheme,
                          .grid = grid,
                          .settings = of_integrator,
                          .watch = options.strict ? Action::strict : Action::stop,
                          // A resumed run was checked when it started.
                          .accept_unstable = options.accept_step || earlier.from.has_value(),
                          .end = result.end,
                          .interval = options.interval.value_or(0),
                          .dropped_rows = result.start.dropped,
                          .description = &description,
                          .event_table = tables.get(),
                          .warn = [this](const Finding& warning) {
                              warn(warning.text);
                              if (warning.name == "model" || warning.name == "soft_friction")
                                  result.warnings.push_back(warning.text);
                          }};
    if (options.coupling != nullptr)
        setup.before_step = [this](lie::March& march) { options.coupling->before_step(march); };
    simulation.emplace(std::move(setup));
    recorder.emplace(RunSetup{.model = *description.model,
                              .outputs = description.outputs,
                              .model_name = description.name,
                              .grid = simulation->grid(),
                              .end = result.end,
                              .directory = directory,
                              .options = options.outputs,
                              .warn = [this](const std::string& what) { warn(what); },
                              .tables = tables,
                              .coupling = options.coupling},
                     simulation->integrator());
    simulation->observe(*recorder);
    if (!options.error) return;
    refined.emplace(*description.model, description.x, *scheme, of_integrator, grid);
    simulation->observe_checked(*refined);
}

// Removes the files of an earlier run, so that they cannot be taken for those of this run.
void SingleRun::clear()
{
    io::Sinks<RunSetup>::remove(directory);
    std::remove(path("events.csv").c_str());
    io::write_file(path("model.json"), text_of_model());
}

std::string SingleRun::text_of_model() const
{
    return result.start.projected ? dae::text_at(description, description.x) : description.text;
}

void SingleRun::open()
{
    remove_figure(directory, "trajectory.png");  // of the shorter run, if this one continues it
    const std::optional<Checkpoint>& from = earlier.from;
    if (from) {
        simulation->resume(*from, earlier.file);
        earlier_seconds = from->wall_seconds;
        result.resumed_at = from->number;
    }
    recorder->open(from);
    if (options.coupling != nullptr)
        options.coupling->begin(simulation->march(), [this](const std::string& what) { add_warning(what); });
    if (from && earlier.has_ended)
        extend();
    else if (options.checkpoint > 0 && !from)
        save();  // the run can be resumed at any time
}

bool SingleRun::at_end() const
{
    return simulation->has_ended() || simulation->number() >= simulation->grid().steps;
}

bool SingleRun::next_step()
{
    try {
        return simulation->step();
    } catch (const lie::Interrupted&) {
        return false;
    }
}

void SingleRun::end()
{
    if (!simulation->has_ended()) {  // by an event
        result.wall_seconds = earlier_seconds + seconds();
        // The two sides end one after the other. A run that is killed in between continues from here.
        if (options.coupling != nullptr) save();
        if (scheme->resumes) final_checkpoint = checkpoint();
        if (options.coupling != nullptr) options.coupling->before_finish();
        const Outcome& outcome = simulation->run();
        if (outcome.status == "interrupted") return interrupted();
        if (outcome.failed()) throw io::NumericalFailure(outcome.status, outcome.text());
    }
    if (simulation->events() == nullptr) return;
    if (const std::string fault = simulation->events()->fault(); !fault.empty())
        throw io::NumericalFailure("event_not_finite", fault);
    for (const std::string& text : simulation->events()->warnings()) warn(text);
}

void SingleRun::failed(const io::NumericalFailure& failure)
{
    const Outcome& outcome = simulation->outcome();
    if (!outcome.failed()) return Resumable::failed(failure);
    io::message("hilda: error[" + outcome.status + "]: " + outcome.message + '\n');
    if (!outcome.detail.empty()) io::message("  " + outcome.detail + '\n');
}

void SingleRun::close()
{
    const Outcome& outcome = simulation->outcome();
    const bool is_between_steps = !simulation->has_ended();  // interrupted, or a failure of the other side
    result.statistics = is_between_steps ? simulation->statistics() : outcome.statistics;
    result.t = is_between_steps ? simulation->state().t : outcome.t;
    result.stopped_by = outcome.stopped_by;
    if (!(result.wall_seconds > 0)) result.wall_seconds = earlier_seconds + seconds();
    recorder->close();
    if (RunEvents* const events = simulation->events()) {
        events->close();
        result.located = events->counts();
    }
    result.invariants = recorder->invariants;
    for (const std::string& warning : warnings(result.invariants, *description.model)) add_warning(warning);
    result.events = contact_events(simulation->integrator(), *description.model, simulation->state().t);
    result.watch = simulation->watch().json();
    for (const Finding& found : simulation->findings())
        if (!message.ends_with(found.text)) add_warning(found.text);  // not the one that ended the run
    if (refined) result.error = refined->estimate(result.events.size());
    if (options.coupling != nullptr) options.coupling->close(code);
}

std::string SingleRun::summary()
{
    result.status = status, result.message = message, result.exit_code = code;
    result.files = files_of_run();
    if (options.plot && options.draw)
        for (const std::string& file : options.draw("trajectory.py", directory, options.figure_formats))
            result.files.push_back(file);
    return run::summary(result).text();
}

std::vector<std::string> SingleRun::files_of_run()
{
    std::vector<std::string> all = {"model.json"};
    const auto add = [&](const std::vector<std::string>& names) {
        all.insert(all.end(), names.begin(), names.end());
    };
    add(recorder->files());
    if (RunEvents* const events = simulation->events()) add(events->files());
    all.emplace_back("summary.json");
    if (status == "interrupted" && scheme->resumes) all.emplace_back("checkpoint");
    return all;
}

double SingleRun::time() const
{
    // The simulation is at its start until open() has resumed it.
    return earlier.from ? std::max(earlier.from->node.t, simulation->state().t) : simulation->state().t;
}

void SingleRun::show(io::ProgressLine& on, Clock::time_point now) const
{
    const lie::Statistics s = simulation->statistics();
    const long first = std::max(0L, result.resumed_at), n = simulation->number();
    const auto all = static_cast<double>(std::max(1L, grid.steps));
    on.completed(static_cast<double>(n) / all, static_cast<double>(first) / all, now);
    on.show(fmt::format("t = {:.3f} / {:g} s, {:.0f} steps/s, {:.1f} iterations/step", time(), result.end,
                        static_cast<double>(n - first) / on.seconds(now),
                        static_cast<double>(s.iterations) / static_cast<double>(std::max(1L, s.steps))),
            now);
}

void SingleRun::before_save()
{
    if (options.coupling != nullptr && final_checkpoint.empty()) options.coupling->save();
}

void SingleRun::write(const io::Append& append)
{
    append(final_checkpoint.empty() ? checkpoint() : final_checkpoint);
}

std::string SingleRun::checkpoint()
{
    Checkpoint c = recorder->checkpoint(simulation->record());
    c.settings = settings;
    c.end = result.end;
    c.interval = grid.interval;
    c.wall_seconds = earlier_seconds + seconds();
    return to_bytes(std::move(c));
}

void SingleRun::add_warning(const std::string& what)
{
    warn(what);
    result.warnings.push_back(what);
}

}  // namespace hilda::run
