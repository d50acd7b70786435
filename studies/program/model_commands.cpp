// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/model_commands.hpp"

#include "io/error.hpp"
#include "io/message.hpp"
#include "lie/schemes.hpp"
#include "run/tables/sink.hpp"
#include "run/watch/run_check.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/command_options.hpp"
#include "studies/program/plot.hpp"

namespace hilda::studies {

namespace {

constexpr const char* of_the_model = "that of the model";

void add_json(CLI::App& c, bool& to)
{
    c.add_flag("--json", to, "print the summary as JSON on stdout, and nothing else");
}

/// Names of the integrators with a property
std::string names_of(bool (*has)(const lie::Scheme& scheme))
{
    std::string names;
    for (const lie::Scheme& scheme : lie::schemes())
        if (has(scheme)) names += (names.empty() ? "" : ", ") + scheme.name;
    return names;
}

}  // namespace

void add_run_options(CLI::App& c, RunArguments& to)
{
    run::RunOptions& o = to.options;
    add_model(c, o.model);
    values(c, "--integrator", "NAME[,NAME...]",
           std::string("integrators, one run each; hilda check names one that suits the model; default: ") +
               run::default_integrator + ", for models with rigid contacts rA-moreau-1",
           append(to.integrators, integrators));
    value(c, "--step", "H",
          "step size [s]; " + names_of([](const lie::Scheme& s) { return s.adaptive_form != nullptr; }) +
              " choose their own without it; " + names_of([](const lie::Scheme& s) { return s.adaptive; }) +
              " always do, and refuse it; default: 1e-3",
          assign(o.step, positive_number));
    value(c, "--end", "T", "end time [s]; default: that of the model, with --resume that of the run",
          assign(o.end, nonnegative_number));
    value(
        c, "--interval", "DT",
        "time between output rows [s], 0: a row for each step; default: end/1000, with --resume that of the "
        "run",
        assign(o.interval, nonnegative_number));
    value(c, "--every", "DT", "old name of --interval", assign(to.every, nonnegative_number))
        ->group("");  // not in the help
    add_settings(c, o.settings, o.given_settings);
    add_set(c, "the model", o.set);
    add_normal_rows(c, of_the_model, o.normal_rows);
    add_fix_initial(c, "", o.fix_initial);
    add_allow_paths(c, "the model", o.allow_paths);
    add_output(c, "--force or --resume", "out/NAME", o.output);
    c.add_flag("--force", o.force, "overwrite an output directory that is not empty");
    c.add_flag("--accept-step", o.accept_step, "run with a step above the stability limit of a force");
    c.add_flag(
        "--resume", o.resume,
        "continue the run in the output directory from its last checkpoint; a complete run continues to a "
        "later --end");
    c.add_flag(
        "--strict", o.strict,
        "end with exit code 4 at the first warning about the solution, such as a large rotation in one step");
    value(c, "--checkpoint", "S", "wall time between checkpoints [s]; default: 0, no checkpoints",
          assign(o.checkpoint, nonnegative_number));
    io::add_sink_options<run::RunSetup>(c, o.outputs);
    o.draw = draw_figures;
    c.add_flag("--plot", o.plot, "draw trajectory.png as well");
    c.add_flag(
        "--error", o.error,
        "estimate the error of the run from runs with half and a quarter of the step (about seven times "
        "the time)");
    add_figure_format(c, o.figure_formats);
    value(c, "--threads", "N", "accepted for compatibility; a run uses one thread",
          assign(o.threads, positive_count));
    add_no_plot(c, "draw no figure (the default)", o.plot);
    add_json(c, o.json);
    c.add_flag("--quiet", o.quiet, "print no result, no warnings and no progress");
    c.add_flag("-v,--verbose", o.verbose, "report initial residuals and checkpoints on stderr");
}

run::RunOptions run_options(const RunArguments& arguments)
{
    run::RunOptions o = arguments.options;
    if (o.force && o.resume) throw io::UsageError("run: --force and --resume exclude each other");
    if (o.error && o.resume) throw io::UsageError("run: --error compares whole runs; --resume excludes it");
    if (arguments.every && o.interval)
        throw io::UsageError("run: --every is the old name of --interval; give only one of them");
    if (arguments.every) o.interval = arguments.every;
    if (arguments.every && !o.quiet)
        io::warning("--every was renamed to --interval; the old name is still read");
    if (!o.figure_formats.empty() && !o.plot)
        throw io::UsageError("run: --figure-format is for figures; it needs --plot");
    if (!arguments.integrators.empty()) o.integrators = arguments.integrators;
    o.chooses_integrator = arguments.integrators.empty();
    return o;
}

void add_cosim_options(CLI::App& c, run::CosimOptions& to)
{
    run::RunOptions& o = to.run;
    c.add_option("FILE", to.file, "path of a co-simulation file")->required()->type_name("");
    value(c, "--end", "T", "end time [s]; default: that of the file", assign(o.end, positive_number));
    value(c, "--interval", "DT", "time between output rows of the mechanism [s]; default: that of the file",
          assign(o.interval, nonnegative_number));
    add_set(c, "the co-simulation file", o.set);
    add_fix_initial(c, "", o.fix_initial);
    add_allow_paths(c, "a file", o.allow_paths);
    add_output(c, "--force or --resume", "out/NAME", o.output);
    c.add_flag("--force", o.force, "overwrite an output directory that is not empty");
    c.add_flag("--accept-step", o.accept_step,
               "run with a step above the stability limit of a force or of the grains");
    c.add_flag(
        "--resume", o.resume,
        "continue the run in the output directory from its last checkpoint; a complete run continues to a "
        "later --end");
    c.add_flag("--strict", o.strict, "end with exit code 4 at the first warning about the solution");
    value(c, "--checkpoint", "S", "wall time between checkpoints [s]; default: 0, no checkpoints",
          assign(o.checkpoint, nonnegative_number));
    value(
        c, "--transport", "NAME",
        "in-process: the grains are computed by this program; pipe: by a process of hilda-granular; mpi: by "
        "rank 1 of mpirun -n 2; default: in-process",
        [&to](const std::string& option, const std::string& text) {
            to.transport = io::one_of(option, text, std::vector<std::string>{"in-process", "pipe", "mpi"});
        });
    value(c, "--threads", "N", "threads of the grains; default: 1", assign(o.threads, positive_count));
    io::add_sink_options<run::RunSetup>(c, o.outputs);
    add_json(c, o.json);
    c.add_flag("--quiet", o.quiet, "print no result, no warnings and no progress");
    c.add_flag("-v,--verbose", o.verbose, "report initial residuals and checkpoints on stderr");
}

void add_kinematics_options(CLI::App& c, run::KinematicsOptions& o)
{
    add_model(c, o.model);
    value(c, "--end", "T", "end time [s]; default: that of the model", assign(o.end, positive_number));
    value(c, "--interval", "DT", "time between output rows [s]; default: end/1000",
          assign(o.interval, positive_number));
    add_set(c, "the model", o.set);
    add_fix_initial(c, "", o.fix_initial);
    add_allow_paths(c, "the model", o.allow_paths);
    add_output(c, "--force", "out/NAME", o.output);
    c.add_flag("--force", o.force, "overwrite an output directory that is not empty");
    io::add_sink_options<run::RunSetup>(c, o.outputs);
    c.get_option("--log-steps")->group("");  // for integrators: it is refused, and not in the help
    add_json(c, o.json);
    c.add_flag("--quiet", o.quiet, "print no result and no warnings");
}

void add_inverse_options(CLI::App& c, run::KinematicsOptions& o)
{
    o.inverse = true;
    add_kinematics_options(c, o);
    value(c, "--motion", "FILE",
          "CSV file with a column t [s] and one for each motion: of a driver, or of a revolute [rad] or "
          "translational [m] joint, from the start; default: the drivers of the model",
          assign(o.motion, [](const std::string&, const std::string& text) { return text; }));
    o.draw = draw_figures;
    add_no_plot(c, "do not draw drives.png", o.plot);
    add_figure_format(c, o.figure_formats);
}

void add_check_options(CLI::App& c, run::CheckOptions& o)
{
    add_model(c, o.model);
    add_set(c, "the model", o.set);
    add_normal_rows(c, of_the_model, o.normal_rows);
    add_fix_initial(c, " and report the change", o.fix_initial);
    value(c, "--fix", "FILE",
          "as --fix-initial, and write the model with the projected initial data to this file",
          assign(o.write, io::path));
    add_allow_paths(c, "the model", o.allow_paths);
    c.add_flag("--json", o.json, "print the result as JSON");
    c.add_flag("--quiet", o.quiet, "print warnings only; the exit code is the result");
}

void add_import_options(CLI::App& c, run::ImportOptions& to)
{
    c.add_option("FILE", to.file, "URDF or MJCF file")->required()->type_name("");
    value(c, "--output", "FILE", "the model file; default: NAME.json in the current directory",
          assign(to.output, io::path));
    value(c, "--base", "fixed|free",
          "whether the first body without a joint is fixed to the ground (default) or free",
          assign(to.free_base, [](const std::string& option, const std::string& text) {
              static const std::string words[] = {"fixed", "free"};
              return io::one_of(option, text, words) == "free";
          }));
    c.add_flag(
        "--balance-inertia", to.balances_inertia,
        "replace principal moments of inertia that no body has, a + b < c, by their mean, as MuJoCo does");
    c.add_flag(
        "--contacts", to.contacts,
        "import the collision geometries as rigid contacts; those of a URDF file with the plane z = 0 too");
    c.add_flag("--force", to.force, "replace a file that exists");
}

void add_export_options(CLI::App& c, run::ExportOptions& to)
{
    c.add_option("MODEL", to.model, "name of a built-in model, or path of a model file")
        ->required()
        ->type_name("");
    value(c, "--output", "FILE", "the URDF file; default: NAME.urdf in the current directory",
          assign(to.output, io::path));
    c.add_flag("--force", to.force, "replace a file that exists");
    add_allow_paths(c, "the model", to.allow_paths);
}

}  // namespace hilda::studies
