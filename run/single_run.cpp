// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/single_run.hpp"

#include "contact/evolving/unilateral.hpp"
#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/option_values.hpp"
#include "io/program.hpp"
#include "io/provenance.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "run/columns/contact_rows.hpp"
#include "run/figures.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/coupling.hpp"
#include "run/recording/setting_options.hpp"
#include "run/tables/run_table.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hilda::run {

namespace {

constexpr const char* interval_option = "--interval";

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

std::string event_name(contact::ContactEvent::Type type)
{
    using Type = contact::ContactEvent::Type;
    return type == Type::lift_off  ? "lift-off"
           : type == Type::impact  ? "impact"
           : type == Type::closing ? "closing"
                                   : "fallback";
}

}  // namespace

SingleRun::SingleRun(const RunOptions& options, const lie::Scheme& scheme, std::string directory)
    : Verbosity{options.quiet, options.verbose}, options(options), scheme(scheme),
      directory(std::move(directory))
{}

RunResult SingleRun::execute()
{
    begin = Clock::now();
    io::OutputLock lock(directory);
    read();
    lie::Settings integrator_settings = options.settings;
    integrator_settings.stop = [] { return io::Interrupt::caught() != 0; };
    const std::shared_ptr<RunTables> tables = run_tables(options.outputs, directory,
                                                         {{"program", version_line()},
                                                          {"command_line", options.command_line},
                                                          {"integrator", scheme.name},
                                                          {"model", description.name},
                                                          {"model_text", text_of_model()}});
    if (!description.events.empty()) refuse_events();
    using Action = Watch::Action;
    Simulation simulation({.model = *description.model,
                           .start = description.x,
                           .scheme = scheme,
                           .grid = grid,
                           .settings = integrator_settings,
                           .watch = options.strict ? Action::strict : Action::stop,
                           // A resumed run was checked when it started.
                           .accept_unstable = options.force || from.has_value(),
                           .end = result.end,
                           .interval = options.interval.value_or(0),
                           .dropped_rows = result.start.dropped,
                           .description = &description,
                           .event_table = tables.get(),
                           .warn = [this](const Finding& warning) {
                               warn(warning.text);
                               if (warning.name == "model" || warning.name == "soft_friction")
                                   result.warnings.push_back(warning.text);
                           }});
    Recorder recorder({.model = *description.model,
                       .outputs = description.outputs,
                       .model_name = description.name,
                       .grid = simulation.grid(),
                       .end = result.end,
                       .directory = directory,
                       .options = options.outputs,
                       .warn = [this](const std::string& what) { warn(what); },
                       .tables = tables,
                       .coupling = options.coupling},
                      simulation.integrator());
    simulation.observe(recorder);
    std::optional<RefinedRuns> refined;
    if (options.error) {
        refined.emplace(*description.model, description.x, scheme, integrator_settings, grid);
        simulation.observe_checked(*refined);
    }
    lock.create();
    if (!from) clear_directory();
    remove_figure(directory, "trajectory.png");  // of the shorter run, if this one continues it
    result.setup_seconds = seconds(Clock::now() - begin);
    march(simulation, recorder);
    if (const auto* unilateral = dynamic_cast<const contact::UnilateralStep*>(&simulation.integrator()))
        for (const contact::ContactEvent& e : unilateral->events())
            if (e.t <=
                simulation.state().t)  // excludes the additional step beyond the end that fills the last node
                result.events.push_back(
                    {e.t, description.model->general_constraints()[static_cast<size_t>(e.contact)]->name,
                     event_name(e.type), e.speed});
    result.watch = simulation.watch().json();
    for (const Finding& found : simulation.findings())
        if (!result.message.ends_with(found.text)) add_warning(found.text);  // not the one that ended the run
    if (refined) result.error = refined->estimate(result.events.size());
    if (options.coupling != nullptr) options.coupling->close(result.exit_code);
    finish(simulation, recorder);
    return std::move(result);
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

void SingleRun::read()
{
    description = named_model(options.model, options.set, options.normal_rows);
    if (options.resume) load_checkpoint();
    if (options.coupling != nullptr) {
        if (!from) {  // an invalid start is reported before the other side writes files
            dae::Description alone = named_model(options.model, options.set, options.normal_rows);
            dae::start(alone, {.fix_initial = options.fix_initial});
        }
        options.coupling->prepare(description, from ? std::optional(from->number) : std::nullopt);
    }
    result.start = dae::start(description, {.fix_initial = options.fix_initial});
    result.end = options.end.value_or(from ? from->end : description.end);
    std::optional<double> interval = options.interval;
    if (!interval && from && scheme.adaptive)
        interval = io::number_in<double>(from->settings[interval_option]);
    grid = time_grid(scheme, result.end, options.step, interval);
    if (from && !options.interval && !scheme.adaptive) grid.interval = from->interval;
    log(fmt::format("{}: initial residuals {:.1e} in position, {:.1e} in velocity{}", description.name,
                    result.start.position_residual, result.start.velocity_residual,
                    result.start.projected ? ", projected" : ""));

    result.model = description.name;
    result.integrator = scheme.name;
    result.step = grid.h;
    result.interval = static_cast<double>(grid.interval) * grid.h;
    result.settings = settings_json(options.settings, &scheme);
    if (scheme.adaptive) {
        result.rtol = options.settings.rtol;
        result.atol = options.settings.atol > 0 ? options.settings.atol : options.settings.rtol;
    }
    result.bodies = description.model->bodies();
    result.constraints = description.model->constraints();
    for (const contact::EvolvingContact* c : evolving_contacts(*description.model))
        result.contacts.push_back(c->name);
    result.set = description.changes;
    result.parameters = description.parameters;
    result.command_line = options.command_line;
    std::vector<std::string> files = options.inputs;
    files.insert(files.end(), description.files.begin(), description.files.end());
    result.inputs = io::inputs(files);
    result.threads = 1;  // the number used, independent of --threads
    result.directory = directory;
    settings = settings_of_run();
    if (from) check_continues();
}

RunSettings SingleRun::settings_of_run()
{
    RunSettings all = options.outputs;
    if (const auto format = all.find(format_option); format != all.end() && format->second == default_format)
        all.erase(format);
    all["model"] = fmt::format("{:016x}", io::checksum(description.text.data(), description.text.size()));
    all["--integrator"] = scheme.name;
    all.merge(given_settings(options.settings, scheme));
    if (!scheme.adaptive) all["--step"] = io::shortest(grid.h);
    all[interval_option] = io::shortest(result.interval);
    // Rows are counted in steps: with another step the rows of the interrupted run would have another
    // interval.
    if (from && !options.interval) all[interval_option] = from->settings[interval_option];
    if (options.fix_initial) all["--fix-initial"] = "";
    if (!options.plugins.empty()) all["--load"] = fmt::format("{}", fmt::join(options.plugins, " --load "));
    return all;
}

void SingleRun::load_checkpoint()
{
    std::error_code error;
    const bool has_ended =
        std::filesystem::exists(path("summary.json"), error) && !io::CheckpointFiles(directory).exist();
    io::CheckpointFiles(directory).load([&](const std::string& bytes, const std::string& file) {
        from = from_bytes(bytes, file);
        from_file = file;
    });
    if (!from && has_ended)
        throw RunHasEnded(directory + ": its run has ended without a checkpoint; --force starts it again");
    if (!from) warn(directory + ": has no checkpoint; starting from the initial state");
    extends = from && has_ended;
}

void SingleRun::check_continues() const
{
    const RunSettings earlier = with_defaults(from->settings), now = with_defaults(settings);
    if (earlier != now) {
        std::error_code error;
        const std::string file = path("model.json");
        throw io::UsageError(fmt::format(
            "{}: the checkpoint belongs to another run: {}; --force starts it again", directory,
            difference(
                earlier, now,
                std::filesystem::exists(file, error) ? io::read_file(file, io::JsonSource::max_bytes) : "",
                text_of_model())));
    }
    check_fits(*from, *description.model, description.x, from_file);
    const bool same_end = lie::TimeGrid::over(from->end, grid.h).steps == grid.steps;
    if (extends && same_end)
        throw RunHasEnded(
            fmt::format("{}: its run is complete, with the end {} s; --end with a later time extends it, "
                        "--force starts it again",
                        directory, from->end));
    if (grid.steps < from->number || (grid.steps == from->number && !same_end))
        throw io::UsageError(
            fmt::format("run: --end must be after t = {} s, which the run in {} has reached, "
                        "got {}; --force starts it again",
                        from->node.t, directory, result.end));
}

// Removes the files of an earlier run, so that they cannot be taken for those of this run.
void SingleRun::clear_directory() const
{
    io::CheckpointFiles(directory).remove();
    io::Sinks<RunSetup>::remove(directory);
    for (const char* file : {"summary.json", "events.csv"}) std::remove(path(file).c_str());
    io::write_file(path("model.json"), text_of_model());
}

std::string SingleRun::text_of_model() const
{
    return result.start.projected ? dae::text_at(description, description.x) : description.text;
}

/// The progress line, the checkpoints and the coupling between the steps
class SingleRun::Loop final : public StepLoop {
public:
    Loop(SingleRun& run, Simulation& simulation, Recorder& recorder)
        : run(run), simulation(simulation), recorder(recorder),
          line(run.options.quiet, run.result.end, run.grid.steps, simulation.number()),
          watch_clock(line.shown() || run.options.checkpoint > 0), saved(Clock::now())
    {}
    ~Loop() override { line.clear(); }

    Next before_step(lie::March& march) override
    {
        if (io::Interrupt::caught() != 0) return Next::interrupt;
        if (run.options.coupling != nullptr) run.options.coupling->before_step(march);
        return Next::step;
    }
    void after_step(const lie::March& march) override
    {
        if (!watch_clock) return;
        const Clock::time_point now = Clock::now();
        line.update(now, march.node().t, march.number(), simulation.integrator().statistics());
        if (run.options.checkpoint > 0 && seconds(now - saved) >= run.options.checkpoint) {
            run.save_checkpoint(simulation, recorder);
            saved = Clock::now();
        }
    }
    void before_finish(const lie::March& /*march*/) override
    {
        line.clear();
        run.result.wall_seconds = run.earlier_seconds + seconds(Clock::now() - run.begin);
        if (run.scheme.resumes) run.final_checkpoint = run.checkpoint(simulation, recorder);
        if (run.options.coupling == nullptr) return;
        // The two sides end one after the other. A run that is killed in between continues from here.
        run.save_checkpoint(simulation, recorder);
        run.options.coupling->before_finish();
    }

private:
    SingleRun& run;
    Simulation& simulation;
    Recorder& recorder;
    Progress line;
    const bool watch_clock;
    Clock::time_point saved;
};

void SingleRun::march(Simulation& simulation, Recorder& recorder)
{
    if (from) {
        simulation.resume(*from, from_file);
        earlier_seconds = from->wall_seconds;
        result.resumed_at = from->number;
    }
    recorder.open(from);
    RunEvents* const events = simulation.events();
    if (options.coupling != nullptr)
        options.coupling->begin(simulation.march(), [this](const std::string& what) { add_warning(what); });
    begin = Clock::now();
    // An extended run is unfinished from here on. A checkpoint at the start, so that the run can be resumed
    // at any time.
    if (extends) std::remove(path("summary.json").c_str());
    if (extends || (options.checkpoint > 0 && !from)) save_checkpoint(simulation, recorder);
    {
        Loop loop(*this, simulation, recorder);
        simulation.run(&loop);
    }
    ended(simulation, recorder);
    result.invariants = recorder.invariants;
    recorder.close();
    if (events != nullptr) {
        events->close();
        result.located = events->counts();
        if (const std::string fault = events->fault(); !fault.empty() && result.status == "ok") {
            result.status = "event_not_finite", result.message = fault;
            result.exit_code = io::exit_code::numerical_failure;
            io::message("hilda: error[" + result.status + "]: " + fault + '\n');
        }
    }
    check_contacts();
    constexpr double largest_residual = 1e-5;  // [m or rad]
    if (description.model->keeps_redundant_rows() && result.invariants.constraint_norm > largest_residual)
        add_warning(
            fmt::format("the constraints with redundant rows are violated by up to {:.1e} m or rad; "
                        "reduce the step",
                        result.invariants.constraint_norm));
}

void SingleRun::add_warning(const std::string& what)
{
    warn(what);
    result.warnings.push_back(what);
}

// Warnings: λ_N ≠ 0 if a surface returns normals that are not those of its points; F_N < 0 in a bilateral
// contact means that bodies free to separate would have separated.
void SingleRun::check_contacts()
{
    const auto contacts = evolving_contacts(*description.model);
    for (size_t k = 0; k < result.contacts.size(); ++k) {
        const ContactExtremes& c = result.invariants.contact[k];
        if (c.normals_differ() && c.lambda_N > ContactExtremes::rounding(*description.model))
            add_warning(fmt::format(
                "contact '{}': lambda_N reaches {:.1e} N at a normal force of {:.1e} N: the normals of its "
                "surfaces do not belong to their contact points",
                result.contacts[k], c.lambda_N, std::max(std::abs(c.F_N_least), c.F_N_most)));
        if (!contacts[k]->unilateral.enabled &&
            c.F_N_least < -ContactExtremes::rounding(*description.model) &&
            c.F_N_least < -1e-9 * std::abs(c.F_N_most))
            add_warning(
                fmt::format("contact '{}': the normal force is tensile, up to {:.3g} N; "
                            "with \"unilateral\": true the bodies would separate",
                            result.contacts[k], -c.F_N_least));
    }
}

/// Records how the simulation ended.
void SingleRun::ended(Simulation& simulation, Recorder& recorder)
{
    const Outcome& outcome = simulation.outcome();
    result.statistics = outcome.statistics;
    result.t = outcome.t;
    result.stopped_by = outcome.stopped_by;
    if (!(result.wall_seconds > 0)) result.wall_seconds = earlier_seconds + seconds(Clock::now() - begin);
    if (outcome.status == "interrupted") {
        result.status = outcome.status;
        result.exit_code = io::exit_code::signal + io::Interrupt::caught();
        if (scheme.resumes) save_checkpoint(simulation, recorder);
        if (!options.quiet)
            io::message(!scheme.resumes ? "hilda: interrupted\n"
                                        : "hilda: interrupted; --resume continues from the checkpoint in " +
                                              directory + '\n');
    } else if (outcome.failed()) {
        result.status = outcome.status;
        result.exit_code = io::exit_code::numerical_failure;
        result.message = outcome.text();
        io::message("hilda: error[" + outcome.status + "]: " + outcome.message + '\n');
        if (!outcome.detail.empty()) io::message("  " + outcome.detail + '\n');
    }
}

std::string SingleRun::checkpoint(Simulation& simulation, Recorder& recorder) const
{
    Checkpoint c = recorder.checkpoint(simulation.record());
    c.settings = settings;
    c.end = result.end;
    c.interval = grid.interval;
    c.wall_seconds = earlier_seconds + seconds(Clock::now() - begin);
    return to_bytes(std::move(c));
}

void SingleRun::save_checkpoint(Simulation& simulation, Recorder& recorder)
{
    if (options.coupling != nullptr) options.coupling->save();
    io::CheckpointFiles(directory).save(checkpoint(simulation, recorder));
    log(fmt::format("checkpoint at step {}", simulation.number()));
}

void SingleRun::finish(Simulation& simulation, const Recorder& recorder)
{
    result.files = recorder.files();
    result.files.insert(result.files.begin(), "model.json");
    if (simulation.events() != nullptr)
        for (const std::string& file : simulation.events()->files()) result.files.push_back(file);
    result.files.emplace_back("summary.json");
    const bool ok = result.status == "ok";
    // In this order, so that a run that is killed here can be resumed.
    if (ok && !final_checkpoint.empty()) io::CheckpointFiles(directory).save_final(final_checkpoint);
    if (result.status == "interrupted" && scheme.resumes) result.files.emplace_back("checkpoint");
    if (options.plot && options.draw)
        for (const std::string& file : options.draw("trajectory.py", directory, options.figure_formats))
            result.files.push_back(file);
    io::write_file(path("summary.json"), summary(result).text());
    if (ok) io::CheckpointFiles(directory).remove_unfinished();
}

}  // namespace hilda::run
