// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/command_line.hpp"

#include "io/error.hpp"
#include "run/cosim/communicator.hpp"
#include "run/cosim/cosim_file.hpp"
#include "run/cosim/grains.hpp"
#include "run/cosim/granular_program.hpp"
#include "run/importing/export_urdf.hpp"
#include "run/importing/import_model.hpp"
#include "run/provenance.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/collect.hpp"
#include "studies/program/columns_help.hpp"
#include "studies/program/command_options.hpp"
#include "studies/program/info.hpp"
#include "studies/program/lists.hpp"
#include "studies/program/model_commands.hpp"
#include "studies/program/new_plugin.hpp"
#include "studies/program/plot.hpp"
#include "studies/program/plugin.hpp"
#include "studies/program/repeating/rerun.hpp"
#include "studies/program/run_study.hpp"
#include "studies/program/study_commands.hpp"
#include "studies/program/view.hpp"

#include "io/nearest.hpp"
#include "io/provenance.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>

namespace hilda::studies {

namespace {

/// The commands of the program, with their options and actions
class Commands {
public:
    /// `plugins`: those that are loaded
    explicit Commands(std::string command_line_text, const std::vector<std::string>& plugins = {})
        : command_line_text(std::move(command_line_text))
    {
        run.options.plugins = study.plugins = repeated.plugins = plugins;
        app.set_version_flag("--version", run::version_line());
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
        add_cosim();
        add_kinematics();
        add_inverse();
        add_check();
        add_models();
        add_integrators();
        add_schema();
        add_study();
        add_collect();
        add_fit();
        add_reproduce();
        add_granular();
        add_plot();
        add_view();
        add_rerun();
        add_import();
        add_export();
        add_info();
        add_new();
        add_help();
    }

    /// The action of the command
    std::function<int()> parse(int argc, char** argv)
    {
        refuse_unknown_command(argc, argv);
        study.words.assign(argv + 1, argv + argc);
        try {
            app.parse(argc, argv);
        } catch (const CLI::CallForHelp&) {
            for (const auto& [command, action] : actions)
                if (command->parsed())
                    return [this, name = command->get_name()] { return help_of(name, kind); };
            return [this] { return help_of("", ""); };
        } catch (const CLI::CallForVersion&) {
            return [] {
                std::cout << run::version_line() << "\nbuild: " << run::build_line()
                          << "\nmodules: " << run::modules_line() << '\n';
                return io::exit_code::done;
            };
        } catch (const CLI::ExtrasError&) {
            refuse_extras();
        } catch (const CLI::ParseError& error) {
            const std::vector<CLI::App*> selected = app.get_subcommands();
            throw io::UsageError((selected.empty() ? "" : selected.front()->get_name() + ": ") +
                                 error.what());
        }
        for (const auto& [command, action] : actions)
            if (command->parsed()) return action;
        throw io::UsageError("no command given; hilda help lists them");
    }

private:
    CLI::App* add(const std::string& name, const std::string& what, std::function<int()> action)
    {
        CLI::App* command = app.add_subcommand(name, what);
        actions.emplace_back(command, std::move(action));
        return command;
    }

    void add_run()
    {
        run.options.command_line = command_line_text;
        add_run_options(*add("run", "simulate a model", [this] { return run_model(run_options(run)); }), run);
    }

    void add_cosim()
    {
        cosim.run.command_line = command_line_text;
        add_cosim_options(*add("cosim", "simulate a mechanism and grains that act on each other",
                               [this] { return run::grains("cosim").run_cosim(cosim); }),
                          cosim);
    }

    void add_kinematics()
    {
        kinematics.command_line = command_line_text;
        add_kinematics_options(
            *add("kinematics",
                 "compute the motion and the driver loads of a mechanism without degrees of freedom",
                 [this] { return run::run_kinematics(kinematics); }),
            kinematics);
    }

    void add_inverse()
    {
        inverse.command_line = command_line_text;
        add_inverse_options(
            *add("inverse", "compute the loads of drivers that give joints a prescribed motion",
                 [this] { return run::run_kinematics(inverse); }),
            inverse);
    }

    void add_check()
    {
        add_check_options(*add("check", "validate a model or a co-simulation file and print its properties",
                               [this] {
                                   return run::is_cosim_file(check.model)
                                              ? run::grains("check").check_cosim(check)
                                              : check_model(check);
                               }),
                          check);
    }

    void add_models()
    {
        CLI::App* c = add("models", "list the built-in models, or write them as model files", [this] {
            if (!name.empty()) return write_model(name, write_to);
            return write_to.empty() ? list_models(json) : write_models(write_to);
        });
        c->add_option("NAME", name, "name of a built-in model; default: print the list")->type_name("");
        value(*c, "--write", "PATH",
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

    void add_schema()
    {
        CLI::App* c = add("schema", "print the JSON schema of model files or of co-simulation files",
                          [this] { return print_schema(of_cosim); });
        c->add_flag("--cosim", of_cosim, "of co-simulation files");
    }

    void add_study()
    {
        study.command_line = command_line_text;
        CLI::App* c =
            add("study", "run a study: table, CSV files and figures; without KIND: list the studies",
                [this] { return kind.empty() ? list_studies(study.json) : run_study(kind, study); });
        add_study_options(*c, kind, study);
    }

    void add_fit()
    {
        fitted.command_line = command_line_text;
        add_fit_options(*add("fit", "fit numbers of a model to measured values, with their uncertainty",
                             [this] { return fit_model(fitted); }),
                        fitted);
    }

    void add_collect()
    {
        CLI::App* c = add("collect", "write the results of a study from its shards (--shard)", [this] {
            const run::JobRecords shards = read_shards(collected.directories);
            std::vector<std::string> words = words_of(shards);
            words.insert(words.begin(), "hilda");
            std::vector<char*> argv;
            for (std::string& word : words) argv.push_back(word.data());
            Commands of_shards(command_line_text, study.plugins);
            of_shards.parse(static_cast<int>(argv.size()), argv.data());
            return collect(collected, shards, of_shards.kind, of_shards.study);
        });
        add_collect_options(*c, collected);
    }

    void add_reproduce()
    {
        add_reproduce_options(
            *add("reproduce", "run the studies of the dissertation and write one page with all results",
                 [this] { return reproduce(reproduction); }),
            reproduction);
    }

    void add_granular()
    {
        CLI::App* c = add("granular", "simulate a granular case, by the program hilda-granular",
                          [this] { return run::start_granular(granular); });
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
        add_plot_options(*c, directory, figures);
    }

    void add_view()
    {
        add_view_options(*add("view", "write a page, or a video, that animates the result of a run",
                              [this]() -> int { view(shown); }),
                         shown);
    }

    void add_import()
    {
        add_import_options(*add("import", "write the model file of a mechanism in a URDF or MJCF file",
                                [this] { return run::import_model(imported); }),
                           imported);
    }

    void add_export()
    {
        add_export_options(*add("export", "write the URDF file of a model that is a tree",
                                [this] { return run::export_model(exported); }),
                           exported);
    }

    void add_rerun()
    {
        CLI::App* c = add("rerun", "repeat the command of a result directory and compare the results",
                          [this] { return rerun(repeated); });
        c->add_option("DIR", repeated.directory, "output directory of a run, a study or a granular run")
            ->required()
            ->type_name("");
        value(*c, "--output", "DIR", "directory of the repetition, new or empty; default: DIR-again",
              assign(repeated.output, io::path));
        value(*c, "--tolerance", "X",
              "numbers may differ by X times the largest number of their column (default 0)",
              assign(repeated.tolerance, io::nonnegative_number));
    }

    void add_info()
    {
        CLI::App* c = add("info", "print version, build, libraries and system, for bug reports",
                          [this] { return info(json, command_line_text); });
        c->add_flag("--json", json, "print the result as JSON");
    }

    void add_new()
    {
        CLI::App* c = add("new", "write the starting point of a plug-in (see --load) or of a granular law",
                          [this] { return new_plugin(kind, name, write_to); });
        c->add_option("KIND", kind, "what is added: integrator, or granular-law")->required()->type_name("");
        c->add_option("NAME", name, "name of the integrator or law")->required()->type_name("");
        value(*c, "--output", "DIR", "directory, new or empty; default: NAME", assign(write_to, io::path));
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
        if (command_name == "granular") return run::start_granular({"--help"});
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
            restrict_help(*known->first, find_study(of_kind));
        else if (command_name != "new" && !of_kind.empty())
            throw io::UsageError("help " + command_name + ": one argument too many: '" + of_kind + "'");
        print_help(*known->first);
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

    RunArguments run;
    run::CosimOptions cosim;
    run::KinematicsOptions kinematics, inverse;
    run::CheckOptions check;
    StudyArguments study;
    CollectOptions collected;
    ReproduceOptions reproduction;
    std::vector<std::string> plugin_files;  ///< for the help; load_plugins() reads --load
    std::string name, write_to, kind, directory;
    FigureOptions figures;  ///< of hilda plot
    FitOptions fitted;
    ViewOptions shown;
    RerunOptions repeated;
    run::ImportOptions imported;
    run::ExportOptions exported;
    bool json = false, of_cosim = false;
    std::vector<std::string> granular;  ///< arguments of hilda-granular
};

/// Throws io::NotAvailable if a plug-in declares an option that a command already has.
std::shared_ptr<Commands> commands_with(const std::vector<std::string>& plugins, const std::string& text)
{
    try {
        return std::make_shared<Commands>(text, plugins);
    } catch (const CLI::OptionAlreadyAdded& error) {
        throw io::NotAvailable(std::string("--load: a plug-in declares an option that a command has: ") +
                               error.what());
    }
}

/// The action refers to `commands`, and keeps it.
std::function<int()> action_of(const std::shared_ptr<Commands>& commands, int argc, char** argv)
{
    return [commands, action = commands->parse(argc, argv)] { return action(); };
}

}  // namespace

std::function<int()> read_command_line(int argc, char** argv)
{
    return action_of(std::make_shared<Commands>(io::shell_quoted(argc, argv)), argc, argv);
}

int command_line(int argc, char** argv)
{
    std::vector<char*> words;
    const std::vector<std::string> plugins = load_plugins({argv, argv + argc}, words);
    const auto commands = commands_with(plugins, io::shell_quoted(argc, argv));
    std::function<int()> action;
    try {
        action = action_of(commands, static_cast<int>(words.size()), words.data());
    } catch (const io::UsageError&) {
        if (run::rank_of_environment() > 0) return io::exit_code::wrong_command_line;  // rank 0 reports it
        throw;
    }
    return action();
}

}  // namespace hilda::studies
