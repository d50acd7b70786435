// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/arguments.hpp"

#include "granular/backend/instruction_set.hpp"
#include "granular/program/device_name.hpp"
#include "granular/program/provenance.hpp"
#include "granular/running/sink.hpp"
#include "io/error.hpp"
#include "io/json.hpp"
#include "io/message.hpp"
#include "io/nearest.hpp"
#include "io/option_values.hpp"
#include "io/provenance.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <set>

namespace hilda::granular {

namespace {

/// Throws io::UsageError for the first argument that is no option of the program, if there is one.
void refuse_extras(const CLI::App& app)
{
    const std::vector<std::string> extras = app.remaining();
    if (extras.empty()) return;
    const std::string& word = extras.front();
    if (!word.starts_with('-')) throw io::UsageError("one argument too many: '" + word + "'");
    std::vector<std::string> known;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    throw io::UsageError("unknown option" + io::with_nearest(word.substr(0, word.find('=')), known));
}

}  // namespace

std::optional<int> read_arguments(int argc, char** argv, Options& o)
{
    std::string step, end, interval, every;
    CLI::App app("hilda-granular: runs a granular case or a validation");
    app.set_version_flag("--version", version_line() + "\n" + build_line());
    /// An option with one value, which `set` receives after the name of the option
    const auto value = [&](const std::string& name, const char* kind, const char* what, const auto& set) {
        return app
            .add_option_function<std::string>(
                name, [=](const std::string& text) { set(name, text); }, what)
            ->type_name(kind);
    };
    const auto positive = [](std::string& to) {
        return [&to](const std::string& option, const std::string& text) {
            io::positive_number(option, text);
            to = text;
        };
    };
    const auto assign = [](auto& to, auto read) {
        return [&to, read](const std::string& option, const std::string& text) { to = read(option, text); };
    };
    app.add_option(
           "CASE", o.run.file,
           "case file (JSON), name of a built-in case or of a validation, cases to list the built-in cases "
           "or to write them as files, export to write a case for another program, laws to list the force "
           "laws, or schema to print the JSON schema of cases")
        ->required()
        ->type_name("");
    app.add_option(
           "NAME", o.name,
           "after cases: the built-in case that is written; default: print the list; after export: the "
           "case, as CASE")
        ->type_name("");
    value("--write", "PATH",
          "after cases: write the case to this file or folder, or without NAME all cases to this folder; "
          "default: stdout",
          assign(o.write_to, io::path));
    app.add_flag("--lammps", o.lammps,
                 "after export: write in.lammps and data.lammps to the output directory, by default "
                 "out/NAME-lammps");
    value("--step", "H", "time step [s]; default: that of the case", positive(step));
    value("--end", "T", "end time [s]; default: that of the case", positive(end));
    value("--interval", "DT", "time between rows of run.csv [s]; default: that of the case, or end/1000",
          positive(interval));
    value("--every", "DT", "old name of --interval", positive(every))->group("");  // not in the help
    app.add_option_function<std::vector<std::string>>(
           "--set",
           [&](const std::vector<std::string>& all) {
               for (const std::string& text : all) o.settings.push_back({io::setting("--set", text)});
           },
           "change one entry of the case, for example /laws/0/mu=0.5; repeatable")
        ->type_name("/json/pointer=VALUE")
        ->allow_extra_args(false);
    value(
        "--seed", "N",
        "seeds of the random numbers of the fills: N, N + 1, ... in their order; default: those of the case",
        assign(o.seed, [](const std::string& option, const std::string& text) {
            const auto n = io::number_in<std::uint64_t>(text);
            if (!n || *n >= std::uint64_t{1} << 53)
                io::refuse_option(option, "must be a whole number from 0 to 2^53 - 1", text);
            return *n;
        }));
    value(
        "--output", "DIR",
        "output directory, new or empty unless --force or --resume is given; default: out/NAME for NAME.json",
        assign(o.run.output, io::path));
    app.add_flag("--force", o.run.force, "overwrite an output directory that is not empty");
    app.add_flag("--accept-step", o.run.accept_step, "run with a step above the stability limit");
    app.add_flag("--allow-paths", o.allow_paths,
                 "read the tables that the case names also if they are not below the folder of the case");
    app.add_flag("--resume", o.run.resume,
                 "continue the run in the output directory from its last checkpoint, also with another "
                 "gravity, motion or law (--set); a complete run continues to a later --end");
    value("--checkpoint", "S",
          "wall time between checkpoints [s]; 0: only after an interruption; default: 600",
          assign(o.run.checkpoint, io::nonnegative_number));
    value("--threads", "N", "number of CPU threads, without influence on the results; default: 1",
          assign(o.threads, [](const std::string& option, const std::string& text) {
              return io::count_up_to(1024, option, text);
          }));
    value("--device", "cpu|cuda[:N]", "device: the CPU, or the GPU with number N; default: cpu",
          [&](const std::string& option, const std::string& text) {
              const std::optional<Device> device = device_named(text);
              if (!device) io::refuse_option(option, "must be cpu, cuda or cuda:N", text);
              o.device = *device;
              o.device_name = text;
          });
    value("--isa", "NAME",
          "vector instructions of the loops on the CPU, without influence on the results: sse2, v3 (AVX2) or "
          "v4 "
          "(AVX-512); default: HILDA_ISA of the environment, or the widest ones that the processor has",
          [](const std::string& option, const std::string& text) { choose_instruction_set(text, option); });
    io::add_sink_options<CaseSetup>(app, o.run.outputs);
    app.add_flag(
        "--exchange", o.exchanges,
        "let another program move boundaries: it sends their motions to stdin and receives the impulses "
        "of the particles from stdout (hilda cosim)");
    app.add_flag("--full", o.full, "run a validation with all parameter values of the dissertation");
    app.add_flag("--strict", o.run.strict,
                 "end with exit code 4 at a warning of the watch, of a stage or of an insertion, and with 3 "
                 "at a column of a table without effect");
    app.add_flag("--json", o.run.json,
                 "print the summary as JSON on stdout, and nothing else; after laws: print the list as JSON");
    app.add_flag("--quiet", o.run.quiet, "print no result, no warnings and no progress");
    app.add_flag("-v,--verbose", o.run.verbose, "report steps, checkpoints and resumption on stderr");
    app.allow_extras();  // refuse_extras() names the nearest option
    app.footer(
        "Exit codes: 0 done, 1 internal error, 2 wrong command line, 3 invalid case, 4 numerical failure,\n"
        "5 input/output, 6 a check of a validation failed, 7 device not available, 129/130/143 interrupted.");
    try {
        app.parse(argc, argv);
        refuse_extras(app);
        if (o.run.file != "cases") {
            if (!o.name.empty() && o.run.file != "export")
                throw io::UsageError("one argument too many: '" + o.name + "'");
            if (!o.write_to.empty()) throw io::UsageError("--write: is valid after cases only");
        }
        if (o.lammps && o.run.file != "export") throw io::UsageError("--lammps: is valid after export only");
        if (o.run.force && o.run.resume) throw io::UsageError("--force and --resume exclude each other");
        if (!every.empty() && !interval.empty())
            throw io::UsageError("--every is the old name of --interval; give only one of them");
    } catch (const CLI::ParseError& e) {
        if (dynamic_cast<const CLI::CallForHelp*>(&e) != nullptr) {
            std::cout << io::wrapped_help(app.help());
            return io::exit_code::done;
        }
        if (e.get_exit_code() == 0) return app.exit(e);
        try {
            refuse_extras(app);  // the cause, if an argument is missing as well
        } catch (const io::UsageError& unknown) {
            return io::report(io::UsageError(std::string("granular: ") + unknown.what()));
        }
        return io::report(io::UsageError(std::string("granular: ") + e.what()));
    } catch (const io::UsageError& e) {
        return io::report(io::UsageError(std::string("granular: ") + e.what()));
    }
    if (!every.empty()) {
        interval = every;  // the origin in messages is then --interval
        if (!o.run.quiet) io::warning("--every was renamed to --interval; the old name is still read");
    }
    std::set<std::string> of_all = {"CASE",  "NAME",   "--write",  "--lammps", "--threads", "--device",
                                    "--isa", "--full", "--strict", "--quiet",  "--verbose"};
    if (o.run.file == "export")
        of_all.insert(
            {"--set", "--seed", "--step", "--end", "--interval", "--output", "--force", "--allow-paths"});
    if (o.run.file == "laws") of_all.insert("--json");
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0 && !of_all.contains(option->get_name()) && o.case_only_option.empty())
            o.case_only_option = option->get_name();
    if (!every.empty())
        o.case_only_option = "--every";  // CLI11 gives no name for options that are not in the help
    for (const auto& [key, given] : {std::pair{"step", step}, {"end", end}, {"interval", interval}})
        if (!given.empty())
            o.settings.push_back({std::string("/") + key + '=' + io::shortest(*io::number_in<double>(given)),
                                  std::string("--") + key + ' ' + given});
    const bool exports = o.run.file == "export" && !o.name.empty();
    if (o.run.output.empty())
        o.run.output = "out/" + std::filesystem::path(exports ? o.name : o.run.file).stem().string() +
                       (exports ? "-lammps" : "");
    o.command_line = argv[0];  // may be "hilda granular"
    if (argc > 1) o.command_line += ' ' + io::shell_quoted(argc - 1, argv + 1);
    return {};
}

}  // namespace hilda::granular
