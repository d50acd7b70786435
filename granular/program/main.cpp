// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda-granular: runs a granular case or a validation, or prints the schema of cases. It is
/// separate from hilda because it may link the CUDA runtime, which must not be linked with GSL.

#include "granular/case/built_in_cases.hpp"
#include "granular/case/case_schema.hpp"
#include "granular/cosim/remote_exchange.hpp"
#include "granular/cosim/soil.hpp"
#include "granular/distributed/processes.hpp"
#include "granular/program/arguments.hpp"
#include "granular/program/cases.hpp"
#include "granular/program/export_lammps.hpp"
#include "granular/program/laws.hpp"
#include "granular/program/memory.hpp"
#include "granular/program/provenance.hpp"
#include "granular/program/validate.hpp"
#include "granular/program/waiting_threads.hpp"
#include "granular/running/earlier_run.hpp"
#include "granular/running/run.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/program.hpp"

#include <omp.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>

#ifdef __GLIBC__
#include <malloc.h>
#endif

using namespace hilda;
using namespace hilda::granular;

namespace {

/// Whether a file of this name can be found; false also for names that the file system does not accept
bool is_file(const std::string& name)
{
    std::error_code error;
    return std::filesystem::exists(name, error);
}

/// Path of the folder of a case. Throws io::InvalidInput if there can be no such file.
std::string folder_of(const std::string& file)
{
    std::error_code error;
    const std::filesystem::path path = std::filesystem::absolute(file, error);
    if (error) throw io::InvalidInput("'" + file + "': is not the name of a file: " + error.message());
    return path.parent_path().string();
}

/// The built-in case that a word names; nullptr if there is none. A file of this name is given with its
/// folder, as ./bed: the files in the working directory do not change the meaning of a word. Throws
/// io::UsageError if the name is that of a validation as well.
const BuiltInCase* built_in_case(const std::string& word)
{
    const BuiltInCase* const found = find_built_in_case(word);
    if (found != nullptr && find_validation(word) != nullptr)
        throw io::UsageError("granular: '" + word +
                             "' is the name of a validation and of a built-in case; write the case to a file "
                             "(hilda-granular cases " +
                             word + " --write FILE) and run the file");
    return found;
}

/// Text of a case file or of a built-in case. Throws io::InvalidInput.
std::string text_of_case(const std::string& word)
{
    if (const BuiltInCase* const found = built_in_case(word)) return found->text;
    try {
        return io::read_file(word, io::JsonSource::max_bytes);
    } catch (const io::IoError& e) {
        throw io::InvalidInput(e.what() + (is_file(word) ? "" : known_names(word)));
    }
}

/// The commands cases, laws and schema, which print a text
void print_text(const Options& o)
{
    if (o.run.file == "cases" && (!o.name.empty() || !o.write_to.empty()))
        write_cases(o.name, o.write_to);
    else if (o.run.file == "cases")
        std::puts(list_of_cases().c_str());
    else if (o.run.file == "laws" && o.run.json)
        std::fputs(laws_as_json().text().c_str(), stdout);
    else if (o.run.file == "laws")
        std::puts(list_of_laws().c_str());
    else
        std::puts(io::written(case_schema()).c_str());
}

/// The grains of a co-simulation with the program that has started this one. That program saves and ends the
/// run after an interruption.
int exchange(RunOptions o, Continuation read)
{
    std::signal(SIGINT, SIG_IGN), std::signal(SIGHUP, SIG_IGN), std::signal(SIGTERM, SIG_IGN);
    o.quiet = true;
    PipeChannel channel(STDIN_FILENO, STDOUT_FILENO, "hilda cosim");
    try {
        serve(channel, [&](const std::vector<std::string>& names) -> std::unique_ptr<Exchange> {
            return std::make_unique<Soil>(o, std::move(read), names);
        });
    } catch (const ExchangeLost&) {  // the other program has reported its error
        return io::exit_code::numerical_failure;
    }
    return io::exit_code::done;
}

/// What the reader of this case gets from the options
Environment environment_of(const Options& o, const std::string& file)
{
    Environment here{.memory = available_memory(),
                     .lists_contacts = o.run.outputs.contains("--contacts"),
                     .device = o.device,
                     .settings = o.settings,
                     .seed = o.seed};
    if (o.device.kind == Device::cuda) here.device_memory = gpu_memory(o.device.number);
    if (!o.allow_paths) here.folder = folder_of(file);
    if (std::error_code error; std::filesystem::is_regular_file(file, error))
        here.base = std::filesystem::path(file).parent_path().string();
    return here;
}

/// The command export
void export_case(const Options& o)
{
    if (o.name.empty()) throw io::UsageError("granular: export: NAME is required, the case");
    if (!o.lammps) throw io::UsageError("granular: export: the format is required, --lammps");
    make_engine(o.device);
    const Case c = read_case(text_of_case(o.name), o.name, environment_of(o, o.name));
    io::check_output_directory(o.run.output, o.run.force, "--force overwrites its files");
    if (!o.run.quiet)
        for (const std::string& notice : c.notices) io::warning(notice);
    insert_particles(c);
    export_lammps(c, o.run.output);
    if (!o.run.quiet)
        std::printf("%s: %zu particles and %zu boundaries for LAMMPS; %s\n", c.name.c_str(), c.world->count(),
                    c.boundaries.size(), o.run.output.c_str());
}

int run_case(const Options& o, int processes)
{
    make_engine(o.device);  // reports a missing device before the case is read
    const Environment here = environment_of(o, o.run.file);
    const std::string text = text_of_case(o.run.file);
    RunOptions options = o.run;
    options.provenance = provenance(o.command_line, o.threads, o.device_name);
    if (processes > 1) options.provenance["processes"] = processes;
    const auto read = [&] { return read_run(options, text, here); };
    Continuation first = read();
    options.provenance["inputs"] = inputs_of(first.c, o.run.file);
    if (o.exchanges) return exchange(options, std::move(first));
    return run(options, std::move(first), read);
}

/// Refuses what a run on several processes does not support, and makes its engine one of all processes.
void share(Options& o, Processes& processes, bool is_validation)
{
    const auto refuse = [&](const std::string& what) {
        throw io::UsageError("mpirun: " + what + " on one process only, got " +
                             std::to_string(processes.count()) + " processes");
    };
    if (is_validation) refuse("the validation " + o.run.file + " runs");
    if (o.device.kind != Device::cpu) refuse("--device " + o.device_name + " is possible");
    o.device.source = &processes.engines();
}

int run_program(int argc, char** argv, Processes* processes)
{
    Options o;
    if (const auto code = read_arguments(argc, argv, o)) return *code;
    omp_set_num_threads(o.threads);
    built_in_case(o.run.file);
    const Validation* const validation = find_validation(o.run.file);
    const bool exports = o.run.file == "export",
               command = exports || o.run.file == "schema" || o.run.file == "laws" || o.run.file == "cases";
    if ((validation != nullptr || command) && !o.case_only_option.empty())
        throw io::UsageError("granular: " + o.case_only_option + ": is valid for cases only, but " +
                             o.run.file + (command ? " is a command" : " is a validation"));
    if (o.full && validation == nullptr && is_file(o.run.file))
        throw io::UsageError("granular: --full: is valid for validations only, but " + o.run.file +
                             " is a file");
    if (command) {
        exports ? export_case(o) : print_text(o);
        return io::exit_code::done;
    }
    if (processes != nullptr) share(o, *processes, validation != nullptr);
    try {
        std::optional<io::Interrupt> interrupt;
        if (validation == nullptr) interrupt.emplace();
        if (validation != nullptr)
            return validate(*validation, {.full = o.full, .device = o.device}, o.run.quiet, o.run.strict);
        const int code = run_case(o, processes != nullptr ? processes->count() : 1);
        if (processes != nullptr && o.run.verbose && !o.run.quiet)
            io::message("hilda: " + processes->report() + '\n');
        return code;
    } catch (const DeviceError& e) {
        throw io::NotAvailable("--device " + o.device_name + ": " + e.what());
    } catch (const std::bad_alloc&) {
        throw io::InvalidInput("the memory is not sufficient for this case");
    }
}

/// Of the processes after the first one. An error ends all of them: the others would wait for a message.
int serve_first(Processes& processes)
{
    int code = io::exit_code::done;
    const int failed = io::run_program([&] {
        code = processes.serve();
        return io::exit_code::done;
    });
    if (failed != io::exit_code::done) processes.abort(io::exit_code::numerical_failure);
    return code;
}

}  // namespace

int main(int argc, char** argv)
{
    let_threads_sleep(argc, argv);
#ifdef __GLIBC__
    // The memory of large arrays and texts returns to the system when they are freed.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
    std::unique_ptr<Processes> processes;
    const int started = io::run_program([&] {
        processes = start_processes(argc, argv);
        return io::exit_code::done;
    });
    if (started != io::exit_code::done) return started;
    if (processes != nullptr && !processes->is_first()) return serve_first(*processes);
    const int code = io::run_program([&] { return run_program(argc, argv, processes.get()); });
    if (processes != nullptr) processes->end(code);
    return code;
}
