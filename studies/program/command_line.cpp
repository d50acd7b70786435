// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/command_line.hpp"

#include "io/error.hpp"
#include "io/message.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/check_model.hpp"
#include "studies/program/columns_help.hpp"
#include "studies/program/granular_program.hpp"
#include "studies/program/info.hpp"
#include "studies/program/kinematics.hpp"
#include "studies/program/lists.hpp"
#include "studies/program/new_plugin.hpp"
#include "studies/program/plugin.hpp"
#include "studies/program/reproduce.hpp"
#include "studies/program/run_model.hpp"
#include "studies/program/run_study.hpp"
#include "studies/running/plot.hpp"
#include "studies/running/provenance.hpp"
#include "studies/running/sink.hpp"

#include "io/nearest.hpp"
#include "io/provenance.hpp"
#include "lie/settings.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>

namespace hilda::studies {

namespace {

/// The commands of the program, with their options and actions
class Commands {
public:
    /// `plugins`: those that are loaded
    explicit Commands(std::string command_line_text, const std::vector<std::string>& plugins = {})
        : command_line_text(std::move(command_line_text))
    {
        run.plugins = study.plugins = plugins;
        app.set_version_flag("--version", version_line());
        app.set_help_flag("-h,--help", "print this text; hilda COMMAND --help: the options of a command");
        app.add_option(
               "--load", plugin_files,
               "load a plug-in: a shared library with integrators, joints, forces, surfaces, laws, problems, "
               "studies or outputs; before the command, repeatable")
            ->type_name("FILE");
        app.require_subcommand(1);
        app.footer(
            "A model is the path of a model file or the name of a built-in model (see hilda models).\n"
            "Exit codes: 0 done, 1 internal error, 2 wrong command line, 3 invalid model or input file,\n"
            "4 numerical failure, 5 input/output, 6 --expect or --check failed, 7 not available,\n"
            "129/130/143 interrupted.");
        add_run();
        add_kinematics();
        add_check();
        add_models();
        add_integrators();
        add_schema();
        add_study();
        add_reproduce();
        add_granular();
        add_plot();
        add_info();
        add_new();
        add_help();
    }

    int parse_and_run(int argc, char** argv)
    {
        refuse_unknown_command(argc, argv);
        try {
            app.parse(argc, argv);
        } catch (const CLI::CallForHelp&) {
            for (const auto& [command, action] : actions)
                if (command->parsed()) return help_of(command->get_name(), kind);
            return help_of("", "");
        } catch (const CLI::CallForVersion&) {
            std::cout << version_line() << '\n';
            return io::exit_code::done;
        } catch (const CLI::ExtrasError&) {
            refuse_extras();
        } catch (const CLI::ParseError& error) {
            const std::vector<CLI::App*> selected = app.get_subcommands();
            throw io::UsageError((selected.empty() ? "" : selected.front()->get_name() + ": ") +
                                 error.what());
        }
        for (const auto& [command, action] : actions)
            if (command->parsed()) return action();
        throw io::UsageError("no command given; hilda help lists them");
    }

private:
    using Setter = std::function<void(const std::string& option, const std::string& text)>;

    CLI::App* add(const std::string& name, const std::string& what, std::function<int()> action)
    {
        CLI::App* command = app.add_subcommand(name, what);
        actions.emplace_back(command, std::move(action));
        return command;
    }

    /// Adds an option with one value, which may be given once
    static CLI::Option* value(CLI::App* command, const std::string& name, const std::string& kind,
                              const std::string& what, Setter set)
    {
        return command
            ->add_option_function<std::string>(
                name, [name, set = std::move(set)](const std::string& text) { set(name, text); }, what)
            ->type_name(kind);
    }

    /// Adds an option with one value, which may be given repeatedly
    static void values(CLI::App* command, const std::string& name, const std::string& kind,
                       const std::string& what, Setter set)
    {
        command
            ->add_option_function<std::vector<std::string>>(
                name,
                [name, set = std::move(set)](const std::vector<std::string>& all) {
                    for (const std::string& text : all) set(name, text);
                },
                what)
            ->type_name(kind)
            ->allow_extra_args(false);
    }

    template <class List, class Read>
    static Setter append(List& to, Read read)
    {
        return [&to, read](const std::string& option, const std::string& text) {
            for (auto& item : read(option, text)) to.push_back(std::move(item));
        };
    }

    template <class Goal, class Read>
    static Setter assign(Goal& to, Read read)
    {
        return [&to, read](const std::string& option, const std::string& text) { to = read(option, text); };
    }

    static std::string unchanged(const std::string& /*option*/, const std::string& text) { return text; }
    static std::vector<std::string> one_sweep(const std::string& /*option*/, const std::string& text)
    {
        return {text};
    }
    static std::vector<std::string> one_setting(const std::string& option, const std::string& text)
    {
        return {setting(option, text)};
    }

    /// The options of lie::Settings, common to run and study; `given` receives the names of those that were
    /// given.
    static void add_settings(CLI::App* c, lie::Settings& s, std::vector<std::string>& given)
    {
        const auto note = [&given](const Setter& set) {
            return [&given, set](const std::string& option, const std::string& text) {
                given.push_back(option);
                set(option, text);
            };
        };
        value(c, "--tolerance", "EPS", "bound on the last Newton correction [m, rad, kg m]; default: 1e-10",
              note(assign(s.tolerance, positive_number)));
        value(c, "--linear-solver", "auto|klu|condensed",
              "solver of the saddle-point system; default: auto, the one with fewer operations",
              note(assign(s.linear_solver, linear_solver)));
        value(c, "--rho-infinity", "RHO",
              "spectral radius of rA-genalpha at infinite frequency, from 0 (strongest damping) to 1 (no "
              "damping); default: 0.8",
              note(assign(s.rho_infinity, fraction)));
        c->add_flag_callback(
            "--reparametrise",
            [&s, &given] {
                s.reparametrise = true;
                given.emplace_back("--reparametrise");
            },
            "change the body frame when Euler angles approach a singular orientation, instead of stopping");
        value(c, "--rtol", "RTOL",
              "relative local error tolerance of integrators with adaptive steps, such as ida-rp; default: "
              "1e-10",
              note(assign(s.rtol, relative_tolerance)));
        value(c, "--atol", "ATOL",
              "absolute local error tolerance of integrators with adaptive steps; default: that of --rtol",
              note(assign(s.atol, absolute_tolerance)));
    }

    static void add_figure_format(CLI::App* c, std::vector<std::string>& to)
    {
        value(c, "--figure-format", "F[,F...]", "formats of the figures, such as png,pdf,svg; default: png",
              assign(to, formats_of_figures));
    }

    void add_run()
    {
        RunOptions& o = run;
        CLI::App* c = add("run", "simulate a model", [this] {
            if (run.force && run.resume) throw io::UsageError("run: --force and --resume exclude each other");
            if (run.error && run.resume)
                throw io::UsageError("run: --error compares whole runs; --resume excludes it");
            if (every && run.interval)
                throw io::UsageError("run: --every is the old name of --interval; give only one of them");
            if (every) run.interval = every;
            if (every && !run.quiet)
                io::warning("--every was renamed to --interval; the old name is still read");
            if (!run.figure_formats.empty() && !run.plot)
                throw io::UsageError("run: --figure-format is for figures; it needs --plot");
            if (!selected_integrators.empty()) run.integrators = selected_integrators;
            run.command_line = command_line_text;
            return run_model(run);
        });
        c->add_option("MODEL", o.model, "path of a model file, or name of a built-in model")
            ->required()
            ->type_name("");
        values(c, "--integrator", "NAME[,NAME...]",
               "integrators, one run each; recommended for contact constraints: rA-half-1-momentum; default: "
               "rA-half-1",
               append(selected_integrators, integrators));
        value(c, "--step", "H", "step size [s]; not for ida-rp, which chooses its own; default: 1e-3",
              assign(o.step, positive_number));
        value(c, "--end", "T", "end time [s]; default: that of the model, with --resume that of the run",
              assign(o.end, nonnegative_number));
        value(
            c, "--interval", "DT",
            "time between output rows [s], 0: a row for each step; default: end/1000, with --resume that of "
            "the run",
            assign(o.interval, nonnegative_number));
        value(c, "--every", "DT", "old name of --interval", assign(every, nonnegative_number))
            ->group("");  // not in the help
        add_settings(c, o.settings, o.given_settings);
        values(c, "--set", "/json/pointer=VALUE", "change one entry of the model; repeatable",
               append(o.set, one_setting));
        value(c, "--normal-rows", "tangent|fixed-xy",
              "tangent vectors in the normal equations of contact constraints; fixed-xy is singular for a "
              "normal in "
              "the x-y plane; default: that of the model",
              assign(o.normal_rows, normal_rows));
        c->add_flag("--fix-initial", o.fix_initial, "project inconsistent initial data onto the constraints");
        value(c, "--output", "DIR",
              "output directory, new or empty unless --force or --resume is given; default: out/NAME",
              assign(o.output, io::path));
        c->add_flag(
            "--force", o.force,
            "overwrite an output directory that is not empty; accept a step above the stability limit");
        c->add_flag("--resume", o.resume,
                    "continue the run in the output directory from its last checkpoint; a complete run "
                    "continues to a later --end");
        value(c, "--checkpoint", "S", "wall time between checkpoints [s]; default: 0, no checkpoints",
              assign(o.checkpoint, nonnegative_number));
        io::add_sink_options<RunSetup>(*c, o.outputs);
        c->add_flag("--plot", o.plot, "draw trajectory.png as well");
        c->add_flag(
            "--error", o.error,
            "estimate the error of the run from runs with half and a quarter of the step (about seven times "
            "the time)");
        add_figure_format(c, o.figure_formats);
        value(c, "--threads", "N", "accepted for compatibility; a run uses one thread",
              assign(o.threads, positive_count));
        c->add_flag_callback(
            "--no-plot", [this] { run.plot = false; }, "draw no figure (the default)");
        c->add_flag("--json", o.json, "print the summary as JSON on stdout, and nothing else");
        c->add_flag("--quiet", o.quiet, "print no result, no warnings and no progress");
        c->add_flag("-v,--verbose", o.verbose, "report initial residuals and checkpoints on stderr");
    }

    void add_kinematics()
    {
        KinematicsOptions& o = kinematics;
        CLI::App* c =
            add("kinematics",
                "compute the motion and the driver loads of a mechanism without degrees of freedom", [this] {
                    kinematics.command_line = command_line_text;
                    return run_kinematics(kinematics);
                });
        c->add_option("MODEL", o.model, "path of a model file, or name of a built-in model")
            ->required()
            ->type_name("");
        value(c, "--end", "T", "end time [s]; default: that of the model", assign(o.end, positive_number));
        value(c, "--interval", "DT", "time between output rows [s]; default: end/1000",
              assign(o.interval, positive_number));
        values(c, "--set", "/json/pointer=VALUE", "change one entry of the model; repeatable",
               append(o.set, one_setting));
        c->add_flag("--fix-initial", o.fix_initial, "project inconsistent initial data onto the constraints");
        value(c, "--output", "DIR",
              "output directory, new or empty unless --force is given; default: out/NAME",
              assign(o.output, io::path));
        c->add_flag("--force", o.force, "overwrite an output directory that is not empty");
        io::add_sink_options<RunSetup>(*c, o.outputs);
        c->add_flag("--json", o.json, "print the summary as JSON on stdout, and nothing else");
        c->add_flag("--quiet", o.quiet, "print no result and no warnings");
    }
    void add_check()
    {
        CheckOptions& o = check;
        CLI::App* c =
            add("check", "validate a model and print its properties", [this] { return check_model(check); });
        c->add_option("MODEL", o.model, "path of a model file, or name of a built-in model")
            ->required()
            ->type_name("");
        values(c, "--set", "/json/pointer=VALUE", "change one entry of the model; repeatable",
               append(o.set, one_setting));
        value(c, "--normal-rows", "tangent|fixed-xy", "as in hilda run; default: that of the model",
              assign(o.normal_rows, normal_rows));
        c->add_flag("--fix-initial", o.fix_initial,
                    "project inconsistent initial data onto the constraints and report the change");
        value(c, "--fix", "FILE",
              "as --fix-initial, and write the model with the projected initial data to this file",
              assign(o.write, io::path));
        c->add_flag("--json", o.json, "print the result as JSON");
        c->add_flag("--quiet", o.quiet, "print warnings only; the exit code is the result");
        c->add_flag("-v,--verbose", verbose, "no effect");
    }

    void add_models()
    {
        CLI::App* c = add("models", "list the built-in models, or write them as model files", [this] {
            if (!name.empty()) return write_model(name, write_to);
            return write_to.empty() ? list_models(json) : write_models(write_to);
        });
        c->add_option("NAME", name, "name of a built-in model; default: print the list")->type_name("");
        value(c, "--write", "PATH",
              "write the model to this file or folder, or without NAME all models to this folder; default: "
              "stdout",
              assign(write_to, io::path));
        c->add_flag("--json", json, "print the list as JSON");
    }

    void add_integrators()
    {
        CLI::App* c = add("integrators", "list the integrators", [this] { return list_integrators(json); });
        c->add_flag("--json", json, "print the list as JSON");
    }

    void add_schema() { add("schema", "print the JSON schema of model files", print_schema); }

    void add_study()
    {
        StudyOptions& o = study;
        CLI::App* c =
            add("study", "run a study: table, CSV files and figures; without KIND: list the studies", [this] {
                study.command_line = command_line_text;
                return kind.empty() ? list_studies(study.json) : run_study(kind, study);
            });
        c->add_option("KIND", kind, "name of the study; default: print the list")->type_name("");
        c->add_option_function<std::vector<std::string>>(
             "MODEL",
             [&o](const std::vector<std::string>& all) {
                 o.problems.insert(o.problems.end(), all.begin(), all.end());
             },
             "built-in models or model files, as --problem")
            ->type_name("");
        values(c, "--problem", "NAME[,NAME...]",
               "built-in models or model files, or the cases of the study; default: those of the study",
               append(o.problems, list));
        values(c, "--integrator", "NAME[,NAME...]", "integrators; default: those of the study",
               append(o.integrators, integrators));
        value(c, "--steps", "H1,H2,...", "step sizes [s]; default: those of the study",
              assign(o.steps, steps));
        value(c, "--rtols", "R1,R2,...",
              "relative tolerances of integrators with adaptive steps; default: those of the study",
              assign(o.rtols, relative_tolerances));
        value(c, "--bars", "N1,N2,...",
              "numbers of bars of the chains of study scaling; default: 1,2,4,...,1024",
              assign(o.bars, bars));
        value(c, "--end", "T", "end time [s]; default: that of the study or of the model",
              assign(o.end, positive_number));
        values(c, "--set", "/json/pointer=VALUE", "change one entry of each model; repeatable",
               append(o.set, one_setting));
        values(c, "--sweep", "/json/pointer=VALUES",
               "values of an entry of the model of study sweep: V1,V2,..., or A:B:N for N numbers from A to "
               "B, or "
               "A:B:N:log; repeatable, for all combinations",
               append(o.sweep, one_sweep));
        value(
            c, "--observable", "COLUMN",
            "quantity that study sweep tabulates and draws: a column of hilda help outputs, such as BODY.rz; "
            "default: that of the model",
            assign(o.observable, unchanged));
        c->add_flag("--keep", o.keep, "write the motion of each run of study sweep to runs/NUMBER as well");
        c->add_flag("--fix-initial", o.fix_initial,
                    "project inconsistent initial data of the models onto the constraints");
        add_settings(c, o.settings, o.given_settings);
        value(c, "--output", "DIR",
              "output directory, new or empty unless --force or --resume is given; default: out/KIND",
              assign(o.output, io::path));
        c->add_flag("--resume", o.resume,
                    "continue the interrupted study in the output directory; its finished runs are not "
                    "computed again");
        value(c, "--reference", "NAME",
              "integrator of the reference solution; default: the reference solution of each problem",
              assign(o.reference, integrator));
        value(c, "--reference-step", "H",
              "step of the reference integrator [s]; default: a tenth of the smallest step of the study",
              assign(o.reference_step, positive_number));
        value(c, "--reference-rtol", "R",
              "relative tolerance of a reference integrator with adaptive steps; default: 1e-12",
              assign(o.reference_rtol, relative_tolerance));
        value(c, "--preset", "balanced|dissertation",
              "parameter set of the friction law; default: that of the study", assign(o.preset, preset));
        value(c, "--normal-rows", "tangent|fixed-xy",
              "tangent vectors in the normal equations of contact constraints; default: tangent",
              assign(o.normal_rows, normal_rows));
        c->add_flag(
            "--all", o.all,
            "study convergence with every problem, integrator and step instead of the short selection");
        c->add_flag("--check", o.check,
                    "evaluate all acceptance criteria of the study; exit code 6 if one fails");
        value(c, "--against", "FILE", "CSV table to compare the result with", assign(o.against, io::path));
        value(c, "--grid", "NAME", "parameter grid of a sweep; default: the finest",
              assign(o.grid, unchanged));
        value(c, "--vtk", "N", "number of ParaView frames of each run; default: no frames",
              assign(o.vtk, frames));
        value(c, "--repeats", "N", "repetitions of each time measurement; default: 5",
              assign(o.repeats, positive_count));
        value(c, "--seed", "N", "seed of random initial velocities; default: 0", assign(o.seed, io::seed));
        c->add_flag("--force", o.force,
                    "overwrite an output directory that is not empty; accept a reference solution that is "
                    "too coarse");
        value(c, "--jobs", "N",
              "number of concurrent runs; default: the number of cores, or 1 in a study that measures time",
              assign(o.jobs, positive_count));
        values(c, "--expect", "KEY=VALUE[+-TOL]",
               "expected value of a result; exit code 6 if the result differs by more than TOL; repeatable",
               append(o.expect, [](const std::string& option, const std::string& text) {
                   return std::vector<Expectation>{expectation(option, text)};
               }));
        c->add_flag_callback(
            "--no-plot", [this] { study.plot = false; }, "draw no figures");
        add_figure_format(c, o.figure_formats);
        c->add_flag("--latex", o.latex,
                    "write study.tex as well: the tables of the text for LaTeX, with the package booktabs");
        c->add_flag("--quiet", o.quiet, "print no result, no warnings and no progress");
        c->add_flag("-v,--verbose", verbose, "no effect");
        c->add_flag("--json", o.json, "print the result as JSON on stdout; write files only with --output");
    }

    void add_reproduce()
    {
        ReproduceOptions& o = reproduction;
        CLI::App* c =
            add("reproduce", "run the studies of the dissertation and write one page with all results",
                [this] { return reproduce(reproduction); });
        values(c, "--chapter", "N[,N...]", "chapters 3, 4, 5, 7, 8; default: all",
               append(o.chapters, [](const std::string& option, const std::string& text) {
                   std::vector<int> chapters;
                   for (const std::string& part : list(option, text))
                       chapters.push_back(io::count_up_to(99, option, part));
                   return chapters;
               }));
        c->add_flag("--quick", o.quick, "reduced grids, 4.5 minutes of CPU time (the default)");
        c->add_flag("--full", o.full, "the grids of the dissertation, hours");
        value(c, "--output", "DIR",
              "output directory, new or empty unless --force or --resume is given; default: out/reproduce",
              assign(o.output, io::path));
        c->add_flag("--resume", o.resume,
                    "continue in the output directory; finished studies are not run again");
        c->add_flag("--force", o.force, "overwrite an output directory that is not empty");
        value(c, "--jobs", "N", "number of concurrent runs; default: the number of cores",
              assign(o.jobs, positive_count));
        c->add_flag_callback(
            "--no-plot", [this] { reproduction.plot = false; }, "draw no figures");
        c->add_flag("--quiet", o.quiet, "print no result and no progress");
    }

    void add_granular()
    {
        CLI::App* c = add("granular", "simulate a granular case, by the program hilda-granular",
                          [this] { return start_granular(granular); });
        c->prefix_command();  // all arguments that follow, --help included, are for hilda-granular
        c->set_help_flag();
        c->callback([this, c] { granular = c->remaining(); });
    }

    void add_plot()
    {
        CLI::App* c =
            add("plot", "draw the figures of a run, a granular run or a study from its CSV files", [this] {
                const auto files = plot(script_for(directory), directory, figures);
                if (!files) return io::exit_code::not_available;
                std::cout << "written to " << directory << ":";
                for (const std::string& file : *files) std::cout << ' ' << file;
                std::cout << '\n';
                return io::exit_code::done;
            });
        c->add_option("DIR", directory, "output directory of a run or a study")->required()->type_name("");
        add_figure_format(c, figures.formats);
        values(c, "--integrator", "NAME[,NAME...]",
               "integrators to show, of those in the table; default: at most eight, those of the "
               "dissertation first",
               append(figures.integrators, list));
        values(
            c, "--quantity", "NAME[,NAME...]",
            "quantities to show, such as r,v,omega; default: all. An unknown name lists those of the figure",
            append(figures.quantities, list));
    }

    void add_info()
    {
        CLI::App* c = add("info", "print version, build, libraries and system, for bug reports",
                          [this] { return info(json, command_line_text); });
        c->add_flag("--json", json, "print the result as JSON");
    }

    void add_new()
    {
        CLI::App* c = add("new", "write the starting point of a plug-in, see --load",
                          [this] { return new_plugin(kind, name, write_to); });
        c->add_option("KIND", kind, "what the plug-in registers: integrator")->required()->type_name("");
        c->add_option("NAME", name, "name of the integrator")->required()->type_name("");
        value(c, "--output", "DIR", "directory, new or empty; default: NAME", assign(write_to, io::path));
    }

    void add_help()
    {
        CLI::App* c = add("help", "print this text, the options of a command, or those of a study",
                          [this] { return help_of(name, kind); });
        c->add_option("COMMAND", name, "name of a command, or outputs: the columns of the tables of a run")
            ->type_name("");
        c->add_option("KIND", kind, "after study: name of the study")->type_name("");
    }

    /// The text of --help, with lines of at most 100 characters
    static void print_help(const CLI::App& of) { std::cout << io::wrapped_help(of.help("hilda")); }

    /// Prints the help of a command, or that of the program without a name.
    int help_of(const std::string& command_name, const std::string& of_kind)
    {
        // app.help() would print the help of a command that has been parsed
        if (command_name.empty()) {
            std::cout << io::wrapped_help(Commands(command_line_text).app.help());
            return io::exit_code::done;
        }
        if (command_name == "granular") return start_granular({"--help"});
        if (command_name == "outputs") {
            std::cout << columns_help();
            return io::exit_code::done;
        }
        const auto known = std::find_if(actions.begin(), actions.end(), [&](const auto& one) {
            return one.first->get_name() == command_name;
        });
        if (known == actions.end())
            throw io::UsageError("help: unknown command" + with_nearest(command_name, names()));
        if (command_name == "study" && !of_kind.empty())
            return help_of_study(*known->first, find_study(of_kind));
        if (command_name != "new" && !of_kind.empty())
            throw io::UsageError("help " + command_name + ": one argument too many: '" + of_kind + "'");
        print_help(*known->first);
        return io::exit_code::done;
    }

    /// Prints the options that a study takes, its keys and its files.
    static int help_of_study(CLI::App& command, const Study& of)
    {
        for (CLI::Option* option : command.get_options())
            if (option->get_positional() || !takes_option(of, option->get_name()) ||
                (option->get_name() == "--expect" && of.keys.empty()))
                command.remove_option(option);
        command.name("study " + of.name);
        command.description(of.answers);
        std::vector<std::string> files = {"study.csv", "study.json"};
        files.insert(files.end(), of.files.begin(), of.files.end());
        command.footer(
            (of.keys.empty() ? "" : fmt::format("Keys of --expect: {}\n", fmt::join(of.keys, ", "))) +
            fmt::format("Files: {}\n", fmt::join(files, ", ")) +
            "Words in capitals stand for names; docs/guide/outputs.md describes the columns.");
        print_help(command);
        return io::exit_code::done;
    }

    std::vector<std::string> names() const
    {
        std::vector<std::string> all;
        for (const auto& known : actions) all.push_back(known.first->get_name());
        return all;
    }

    /// io::UsageError with the nearest known command. CLI11 would only report an unexpected argument.
    void refuse_unknown_command(int argc, char** argv) const
    {
        if (argc < 2) throw io::UsageError("no command given; hilda help lists them");
        const std::string word = argv[1];
        const std::vector<std::string> known = names();
        if (!word.starts_with('-') && std::find(known.begin(), known.end(), word) == known.end())
            throw io::UsageError("unknown command" + with_nearest(word, known) + " (hilda help lists them)");
    }

    [[noreturn]] void refuse_extras() const
    {
        const std::vector<CLI::App*> selected = app.get_subcommands();
        const CLI::App* command = selected.empty() ? &app : selected.front();
        const std::vector<std::string> extras = app.remaining(true);
        const std::string word = extras.empty() ? "" : extras.front(),
                          option = word.substr(0, word.find('='));
        std::vector<std::string> known;
        for (const CLI::Option* o : command->get_options())
            for (const std::string& long_name : o->get_lnames()) known.push_back("--" + long_name);
        const std::string where = selected.empty() ? "" : command->get_name() + ": ";
        if (option == "--load")
            throw io::UsageError(where + "--load goes before the command: hilda --load FILE " +
                                 (selected.empty() ? "COMMAND" : command->get_name()));
        if (word.starts_with('-'))
            throw io::UsageError(where + "unknown option" + with_nearest(option, known));
        throw io::UsageError(where + "one argument too many: '" + word + "'");
    }

    const std::string command_line_text;
    CLI::App app{"HILDA: multibody dynamics on the Lie group", "hilda"};
    std::vector<std::pair<CLI::App*, std::function<int()>>> actions;

    RunOptions run;
    std::optional<double> every;  ///< value of --every, the old name of --interval
    KinematicsOptions kinematics;
    CheckOptions check;
    StudyOptions study;
    ReproduceOptions reproduction;
    std::vector<std::string> selected_integrators;
    std::vector<std::string> plugin_files;  ///< for the help; load_plugins() reads --load
    std::string name, write_to, kind, directory;
    FigureOptions figures;  ///< of hilda plot
    bool json = false, verbose = false;
    std::vector<std::string> granular;  ///< arguments of hilda-granular
};

/// Loads the plug-ins of the options --load FILE before the command, and returns them (see load_plugin()) and
/// the other words. The options of a command name registered integrators, so that these must exist before the
/// command line is read.
std::vector<std::string> load_plugins(const std::vector<char*>& given, std::vector<char*>& words)
{
    std::vector<std::string> plugins;
    size_t k = 0;
    if (k < given.size()) words.push_back(given[k++]);
    for (; k < given.size() && std::string_view(given[k]).starts_with("--load"); ++k) {
        const std::string_view word = given[k];
        if (word != "--load" && !word.starts_with("--load=")) break;
        if (word == "--load" && ++k == given.size()) throw io::UsageError("--load: needs a FILE");
        plugins.push_back(load_plugin(word == "--load" ? given[k] : std::string(word.substr(7))));
    }
    words.insert(words.end(), given.begin() + static_cast<std::ptrdiff_t>(k), given.end());
    return plugins;
}

}  // namespace

int command_line(int argc, char** argv)
{
    std::vector<char*> words;
    const std::vector<std::string> plugins = load_plugins({argv, argv + argc}, words);
    return Commands(io::shell_quoted(argc, argv), plugins)
        .parse_and_run(static_cast<int>(words.size()), words.data());
}

}  // namespace hilda::studies
