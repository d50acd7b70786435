// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/command_line.hpp"

#include "studies/exit_codes.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/check_model.hpp"
#include "studies/program/granular_program.hpp"
#include "studies/program/info.hpp"
#include "studies/program/lists.hpp"
#include "studies/program/plot.hpp"
#include "studies/program/run_model.hpp"
#include "studies/program/run_study.hpp"

#include "dae/nearest.hpp"

#include <CLI/CLI.hpp>

#include <functional>
#include <iostream>
#include <memory>

namespace hilda::studies {

namespace {

/// The words as they could be typed again
std::string joined(int argc, char** argv)
{
    std::string line;
    for (int k = 0; k < argc; ++k) {
        const std::string word = argv[k];
        const bool plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=/.,:@%") == std::string::npos;
        line += k > 0 ? " " : "";
        if (plain) {
            line += word;
            continue;
        }
        line += '\'';
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += '\'';
    }
    return line;
}

/// The program's commands, each with its options and what it does
class Commands {
public:
    explicit Commands(std::string typed) : typed(std::move(typed))
    {
        app.set_version_flag("--version", version_line());
        app.set_help_flag("-h,--help", "this text; hilda COMMAND --help for one command");
        app.require_subcommand(1);
        app.footer(
            "A model is a path, or the name of a built-in one (hilda models).\n"
            "Exit codes: 0 done, 1 internal error, 2 wrong command line, 3 invalid model or input file,\n"
            "4 numerical failure, 5 input/output, 6 an --expect failed, 7 not available, 130/143 "
            "interrupted.");
        add_run();
        add_check();
        add_models();
        add_integrators();
        add_study();
        add_granular();
        add_plot();
        add_info();
        add_help();
    }

    int parse_and_run(int argc, char** argv)
    {
        refuse_unknown_command(argc, argv);
        try {
            app.parse(argc, argv);
        } catch (const CLI::CallForHelp&) {
            std::cout << app.help();
            return exit_code::done;
        } catch (const CLI::CallForVersion&) {
            std::cout << version_line() << '\n';
            return exit_code::done;
        } catch (const CLI::ExtrasError&) {
            refuse_extras();
        } catch (const CLI::ParseError& error) {
            const std::vector<CLI::App*> selected = app.get_subcommands();
            throw UsageError((selected.empty() ? "" : selected.front()->get_name() + ": ") + error.what());
        }
        for (const auto& [command, action] : actions)
            if (command->parsed()) return action();
        throw UsageError("no command given; hilda help lists them");
    }

private:
    using Set = std::function<void(const std::string& option, const std::string& text)>;

    CLI::App* add(const std::string& name, const std::string& what, std::function<int()> action)
    {
        CLI::App* command = app.add_subcommand(name, what);
        actions.emplace_back(command, std::move(action));
        return command;
    }

    /// An option with a value, which is given once
    static void value(CLI::App* command, const std::string& name, const std::string& kind,
                      const std::string& what, Set set)
    {
        command
            ->add_option_function<std::string>(
                name, [name, set = std::move(set)](const std::string& text) { set(name, text); }, what)
            ->type_name(kind);
    }

    /// An option that may be given more than once, each time with one value
    static void values(CLI::App* command, const std::string& name, const std::string& kind,
                       const std::string& what, Set set)
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
    static Set append(List& to, Read read)
    {
        return [&to, read](const std::string& option, const std::string& text) {
            for (auto& item : read(option, text)) to.push_back(std::move(item));
        };
    }

    template <class Goal, class Read>
    static Set assign(Goal& to, Read read)
    {
        return [&to, read](const std::string& option, const std::string& text) { to = read(option, text); };
    }

    static std::string as_it_is(const std::string& /*option*/, const std::string& text) { return text; }
    static std::vector<std::string> one_setting(const std::string& option, const std::string& text)
    {
        return {setting(option, text)};
    }
    static std::string path(const std::string& option, const std::string& text)
    {
        if (text.empty()) throw UsageError(option + ": must not be empty");
        return text;
    }

    /// What the schemes are told, the same for every command that runs them
    static void add_settings(CLI::App* c, lie::Settings& s)
    {
        value(c, "--tolerance", "EPS",
              "Newton's method stops at corrections below, by default 1e-10 in m, rad, kg m",
              assign(s.tolerance, positive_number));
        value(c, "--linear-solver", "auto|klu|condensed",
              "of the saddle system; by default the one with fewer operations",
              assign(s.linear_solver, linear_solver));
        value(c, "--rho-infinity", "RHO",
              "damping of rA-genalpha, from 0, the most, to 1, none; by default 0.8",
              assign(s.rho_infinity, fraction));
        c->add_flag("--reparametrise", s.reparametrise,
                    "Euler angles turn to another body frame near their singular set, instead of stopping");
        value(c, "--rtol", "RTOL", "relative error of a step of ida-rp, by default 1e-10",
              assign(s.rtol, relative_tolerance));
        value(c, "--atol", "ATOL", "the same, absolute, by default as --rtol",
              assign(s.atol, absolute_tolerance));
    }

    void add_run()
    {
        RunOptions& o = run;
        CLI::App* c = add("run", "simulate one model", [this] {
            if (run.force && run.resume) throw UsageError("run: --force and --resume exclude each other");
            if (!selected_integrators.empty()) run.integrators = selected_integrators;
            run.command_line = typed;
            return run_model(run);
        });
        c->add_option("MODEL", o.model, "path of a model file, or name of a built-in model")
            ->required()
            ->type_name("");
        values(c, "--integrator", "NAME[,NAME...]",
               "one run each, by default rA-half-1; with contacts that are constraints rA-half-1-momentum is "
               "recommended",
               append(selected_integrators, integrators));
        value(c, "--step", "H", "step size in s, by default 1e-3; not for ida-rp, which chooses its own",
              assign(o.step, positive_number));
        value(c, "--end", "T", "end in s, by default the model's", assign(o.end, nonnegative_number));
        value(c, "--every", "DT", "s between output rows, by default end/1000; 0: every step",
              assign(o.interval, nonnegative_number));
        add_settings(c, o.settings);
        values(c, "--set", "/json/pointer=VALUE", "change one entry of the model; repeatable",
               append(o.set, one_setting));
        value(c, "--normal-rows", "tangent|fixed-xy",
              "what the normals of contacts that are constraints are projected on, by default as the model "
              "has it; "
              "fixed-xy fails where a normal lies in the plane of x and y",
              assign(o.normal_rows, normal_rows));
        c->add_flag("--fix-initial", o.fix_initial, "project initial data that violate the constraints");
        value(c, "--output", "DIR", "by default out/NAME", assign(o.output, path));
        c->add_flag("--force", o.force,
                    "write into a directory that is not empty; take a step at which a force is not stable");
        c->add_flag("--resume", o.resume, "go on from the last checkpoint in the directory");
        value(c, "--vtk", "DT", "s between frames of the bodies in contact, for ParaView",
              assign(o.vtk, positive_number));
        value(c, "--checkpoint", "S", "wall seconds between checkpoints, by default 0: none",
              assign(o.checkpoint, nonnegative_number));
        c->add_flag("--reactions", o.reactions, "also write constraint forces and multipliers");
        c->add_flag("--log-steps", o.log_steps, "also write steps.csv, a line for each step");
        c->add_flag("--plot", o.plot, "also draw trajectory.png");
        value(c, "--threads", "N", "threads inside one run; results are the same for any, and one is used",
              assign(o.threads, positive_count));
        c->add_flag_callback(
            "--no-plot", [this] { run.plot = false; }, "draw no figure, as by default");
        c->add_flag("--json", o.json, "the summary as JSON on stdout, and nothing else there");
        c->add_flag("--quiet", o.quiet, "print neither result nor warnings nor progress");
        c->add_flag("-v,--verbose", o.verbose, "say what is done");
    }

    void add_check()
    {
        CheckOptions& o = check;
        CLI::App* c = add("check", "validate a model and say what it is; change nothing",
                          [this] { return check_model(check); });
        c->add_option("MODEL", o.model, "path of a model file, or name of a built-in model")
            ->required()
            ->type_name("");
        values(c, "--set", "/json/pointer=VALUE", "change one entry of the model; repeatable",
               append(o.set, one_setting));
        value(c, "--normal-rows", "tangent|fixed-xy", "as in run", assign(o.normal_rows, normal_rows));
        c->add_flag("--fix-initial", o.fix_initial, "say what projecting the initial data would change");
        c->add_flag("--json", o.json, "the result as JSON");
        c->add_flag("--quiet", o.quiet, "only the exit code");
        c->add_flag("-v,--verbose", verbose, "as by default");
    }

    void add_models()
    {
        CLI::App* c = add("models", "list the built-in models, or write one as JSON",
                          [this] { return name.empty() ? list_models(json) : write_model(name, write_to); });
        c->add_option("NAME", name, "the model to write")->type_name("");
        value(c, "--write", "FILE", "write it there, not to stdout", assign(write_to, path));
        c->add_flag("--json", json, "the list as JSON");
    }

    void add_integrators()
    {
        CLI::App* c = add("integrators", "list the integrators", [this] { return list_integrators(json); });
        c->add_flag("--json", json, "the list as JSON");
    }

    void add_study()
    {
        StudyOptions& o = study;
        CLI::App* c =
            add("study", "an experiment: its table, CSV and figures; without KIND, the list of them", [this] {
                study.command_line = typed;
                return kind.empty() ? list_studies(study.json) : run_study(kind, study);
            });
        c->add_option("KIND", kind, "which one")->type_name("");
        values(c, "--problem", "NAME[,NAME...]", "built-in models or model files", append(o.problems, list));
        values(c, "--integrator", "NAME[,NAME...]", "by default all", append(o.integrators, integrators));
        value(c, "--steps", "H1,H2,...", "step sizes in s", assign(o.steps, steps));
        value(c, "--rtols", "R1,R2,...", "tolerances of integrators that choose their own steps",
              assign(o.rtols, relative_tolerances));
        value(c, "--bars", "N1,N2,...", "lengths of the chain of scaling, by default 1,2,4,...,1024",
              assign(o.bars, bars));
        value(c, "--end", "T", "end in s, by default the model's", assign(o.end, positive_number));
        values(c, "--set", "/json/pointer=VALUE", "change one entry of each model; repeatable",
               append(o.set, one_setting));
        add_settings(c, o.settings);
        value(c, "--output", "DIR", "by default out/KIND", assign(o.output, path));
        value(c, "--reference", "NAME", "the integrator to judge by, by default the truth of each problem",
              assign(o.reference, integrator));
        value(c, "--reference-step", "H", "its step in s, by default a tenth of the smallest one judged",
              assign(o.reference_step, positive_number));
        value(c, "--reference-rtol", "R", "its tolerance where it chooses its own steps, by default 1e-12",
              assign(o.reference_rtol, relative_tolerance));
        value(c, "--preset", "balanced|dissertation", "of the friction", assign(o.preset, preset));
        value(c, "--normal-rows", "tangent|fixed-xy",
              "of contacts that are constraints, by default tangent; fixed-xy shows where it fails",
              assign(o.normal_rows, normal_rows));
        c->add_flag("--check", o.check,
                    "do all that a study is judged by; exit with 6 where something does not come out");
        value(c, "--against", "FILE", "a CSV table to compare the result with", assign(o.against, path));
        value(c, "--grid", "NAME", "of a sweep, by default the finest", assign(o.grid, as_it_is));
        value(c, "--vtk", "N", "so many frames of each run for ParaView", assign(o.vtk, frames));
        value(c, "--repeats", "N", "of what is timed, by default 5", assign(o.repeats, positive_count));
        value(c, "--seed", "N", "of random starts, by default 0", assign(o.seed, seed));
        c->add_flag("--force", o.force,
                    "write into a directory that is not empty; take a reference coarser than what it judges");
        value(c, "--jobs", "N", "runs side by side, by default one for each core; one where time is measured",
              assign(o.jobs, positive_count));
        values(c, "--expect", "KEY=VALUE[+-TOL]", "exit with 6 when this does not come out; repeatable",
               append(o.expect, [](const std::string& option, const std::string& text) {
                   return std::vector<Expectation>{expectation(option, text)};
               }));
        c->add_flag_callback(
            "--no-plot", [this] { study.plot = false; }, "draw no figures");
        c->add_flag("--quiet", o.quiet, "print neither result nor progress");
        c->add_flag("-v,--verbose", verbose, "as by default");
        c->add_flag("--json", o.json, "the result as JSON on stdout; files only with --output");
    }

    void add_granular()
    {
        CLI::App* c = add("granular", "a granular case, by the program hilda-granular beside this one",
                          [this] { return start_granular(granular); });
        c->prefix_command();  // all that follows is for the other program, --help too
        c->set_help_flag();
        c->callback([this, c] { granular = c->remaining(); });
    }

    void add_plot()
    {
        CLI::App* c = add("plot", "draw the figures again from the CSV files in a directory", [this] {
            return plot(script_for(directory), directory) ? exit_code::done : exit_code::not_available;
        });
        c->add_option("DIR", directory, "of a run or a study")->required()->type_name("");
    }

    void add_info()
    {
        CLI::App* c = add("info", "version, build, libraries, devices: what a bug report needs",
                          [this] { return info(json, typed); });
        c->add_flag("--json", json, "the same as JSON");
    }

    void add_help()
    {
        CLI::App* c = add("help", "this text, or the help of a command", [this] {
            const CLI::App* command = nullptr;
            for (const auto& known : actions)
                if (known.first->get_name() == name) command = known.first;
            if (!name.empty() && command == nullptr)
                throw UsageError("help: unknown command" + with_nearest(name, names()));
            // help() of the whole would show the command "help", which has been parsed
            std::cout << (command != nullptr ? command->help("hilda") : Commands(typed).app.help());
            return exit_code::done;
        });
        c->add_option("COMMAND", name)->type_name("");
    }

    std::vector<std::string> names() const
    {
        std::vector<std::string> all;
        for (const auto& known : actions) all.push_back(known.first->get_name());
        return all;
    }

    /// CLI11 would only say that the word was not expected.
    void refuse_unknown_command(int argc, char** argv) const
    {
        if (argc < 2) throw UsageError("no command given; hilda help lists them");
        const std::string word = argv[1];
        const std::vector<std::string> known = names();
        if (!word.starts_with('-') && std::find(known.begin(), known.end(), word) == known.end())
            throw UsageError("unknown command" + with_nearest(word, known) + " (hilda help lists them)");
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
        if (word.starts_with('-')) throw UsageError(where + "unknown option" + with_nearest(option, known));
        throw UsageError(where + "one argument too many: '" + word + "'");
    }

    const std::string typed;
    CLI::App app{"HILDA: multibody dynamics on the Lie group", "hilda"};
    std::vector<std::pair<CLI::App*, std::function<int()>>> actions;

    RunOptions run;
    CheckOptions check;
    StudyOptions study;
    std::vector<std::string> selected_integrators;
    std::string name, write_to, kind, directory;
    bool json = false, verbose = false;
    std::vector<std::string> granular;  ///< arguments of hilda-granular
};

}  // namespace

int command_line(int argc, char** argv) { return Commands(joined(argc, argv)).parse_and_run(argc, argv); }

}  // namespace hilda::studies
