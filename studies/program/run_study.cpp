// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/run_study.hpp"

#include "io/files.hpp"
#include "io/message.hpp"
#include "io/nearest.hpp"
#include "io/program.hpp"
#include "run/cosim/communicator.hpp"
#include "run/cosim/grains.hpp"
#include "studies/framework/study.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/program/study_option_table.hpp"
#include "studies/program/study_results.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <thread>

namespace hilda::studies {

const Study& find_study(const std::string& kind)
{
    std::vector<std::string> known;
    for (const Study& study : studies()) {
        if (study.name == kind) return study;
        known.push_back(study.name);
    }
    if (kind.starts_with("granular-")) run::grains("study " + kind);  // says what is missing
    throw io::UsageError("study: unknown study" + io::with_nearest(kind, known) +
                         " (hilda study lists them)");
}

namespace {

/// Completes the options by defaults. io::UsageError for options that exclude each other.
void complete(StudyArguments& arguments, const Study& study)
{
    StudyOptions& options = arguments.options;
    const std::string where = "study " + study.name + ": ";
    const auto refuse = [&](const std::string& what) { throw io::UsageError(where + what); };
    refuse_options_of_others(study, options);
    const bool timed = study.lists("--repeats");  // concurrent runs would disturb the measurement
    if (timed && options.repeats == 0) options.repeats = 5;
    if (options.jobs == 0)
        options.jobs = timed ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    if (options.output.empty() && !arguments.json)
        options.output =
            "out/" + study.name +
            (options.shard.is_part() ? fmt::format("-{}-of-{}", options.shard.index, options.shard.count)
                                     : "");
    if (options.output.empty()) {
        if (options.shard.is_part()) refuse("--shard writes a file: with --json it needs --output");
        if (!arguments.figure_formats.empty() && arguments.plot)
            refuse("--figure-format is for figures; with --json they need --output");
        if (arguments.latex) refuse("--latex writes a file: with --json it needs --output");
        if (options.resume) refuse("--resume needs the --output of the interrupted study");
    }
    if (!arguments.figure_formats.empty() && !arguments.plot)
        refuse("--figure-format is for figures; --no-plot draws none");
    if (options.resume && options.force) refuse("--force and --resume exclude each other");
}

/// io::UsageError for a key of --expect that the study does not have, and for --vtk without a directory
void check_results(const Study& study, const StudyOptions& options)
{
    const std::string where = "study " + study.name + ": ";
    for (const Expectation& e : options.expect) {
        if (std::find(study.keys.begin(), study.keys.end(), e.key) != study.keys.end()) continue;
        if (study.keys.empty()) throw io::UsageError(where + "--expect is not an option of this study");
        throw io::UsageError(fmt::format("{}--expect: unknown key{}; known keys: {}", where,
                                         io::with_nearest(e.key, study.keys), fmt::join(study.keys, ", ")));
    }
    if (options.vtk > 0 && options.output.empty())
        throw io::UsageError(where + "--vtk writes files: with --json it needs --output");
}

/// The words of the command line for hilda collect; empty if there is no shard
std::string command_of(const StudyArguments& arguments)
{
    std::string all;
    if (arguments.options.shard.is_part())
        for (const std::string& word : arguments.words) all += word + '\0';
    return all;
}

/// The results of the jobs that a run of the study keeps; nullptr without an output directory
std::unique_ptr<run::FinishedJobs> finished_jobs(const Study& study, const StudyArguments& arguments,
                                                 const run::JobRecords* collected)
{
    const StudyOptions& options = arguments.options;
    if (collected != nullptr)
        return std::make_unique<run::FinishedJobs>(*collected, identity_of_jobs(study, arguments));
    if (options.output.empty()) return nullptr;
    auto finished = std::make_unique<run::FinishedJobs>(options.output, identity_of_jobs(study, arguments),
                                                        options.resume, command_of(arguments));
    if (options.resume && !options.quiet)
        io::message(fmt::format(
            "hilda: {} read from {}\n",
            io::counted(static_cast<long>(finished->count()), "finished job is", "finished jobs are"),
            options.output));
    return finished;
}

int run_here(const Study& study, const StudyArguments& arguments, const run::JobRecords* collected)
{
    const StudyOptions& options = arguments.options;
    std::optional<io::OutputLock> lock;
    if (!options.output.empty()) {
        const bool accepted = options.force || options.resume;
        const std::string remedies =
            run::FinishedJobs::in(options.output) ? io::force_or_resume : io::force_overwrites;
        io::check_output_directory(options.output, accepted, remedies);
        lock.emplace(options.output, accepted, remedies).create();
    }
    const io::EndOnSignal end_on_signal(options.output.empty() || collected != nullptr
                                            ? ""
                                            : "interrupted; the finished runs are kept in " + options.output +
                                                  ", the same command with --resume continues");
    std::unique_ptr<run::FinishedJobs> finished;
    try {
        check_results(study, options);
        finished = finished_jobs(study, arguments, collected);
        StudyContext context(study, options, finished.get());
        study.run(context);
        return finish(study, context, arguments, finished.get());
    } catch (const run::PartDone&) {
        return finish_shard(study, arguments, *finished);
    } catch (...) {
        finished.reset();
        if (!options.output.empty())
            rmdir(options.output.c_str());  // fails, as intended, if the directory is not empty
        throw;
    }
}

}  // namespace

int run_study(const std::string& kind, StudyArguments arguments)
{
    const Study& study = find_study(kind);
    complete(arguments, study);
    if (const int ranks = run::ranks_of_environment(); ranks > 1 && !arguments.options.shard.is_part())
        throw io::UsageError(
            fmt::format("study {}: each of the {} processes of mpirun would compute the whole "
                        "study; use --shard I/N and hilda collect",
                        kind, ranks));
    return run_here(study, arguments, nullptr);
}

int run_collected(const std::string& kind, StudyArguments arguments, const run::JobRecords& collected)
{
    const Study& study = find_study(kind);
    complete(arguments, study);
    return run_here(study, arguments, &collected);
}

}  // namespace hilda::studies
