// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/run_study.hpp"

#include "io/files.hpp"
#include "io/program.hpp"
#include "run/cosim/communicator.hpp"
#include "run/cosim/grains.hpp"
#include "run/recording/setting_options.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/command_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <thread>

namespace hilda::studies {

namespace {

/// An option that not every study has
struct OptionOfSome {
    std::string name;
    unsigned taken = 0;    ///< the flags of `takes` with which a study has it; 0: all studies
    unsigned lacking = 0;  ///< the flags of `lacks` without which a study has it
    std::function<bool(const StudyOptions&)> given;
};

bool has(const Study& study, const OptionOfSome& option)
{
    return (option.taken == 0 || (study.accepted & option.taken) != 0) &&
           (study.lacking & option.lacking) == 0;
}

/// The flags of `takes` with which a study has this option of lie::Settings; 0: all studies of models
unsigned studies_with(const std::string& setting)
{
    return setting == "--rtol" ? takes::rtol : setting == "--atol" ? takes::rtol | takes::rtols : 0;
}

const std::vector<OptionOfSome>& options_of_some()
{
    static const std::vector<OptionOfSome> all = [] {
        std::vector<OptionOfSome> some = {
            {"--problem", 0, lacks::problem, [](const auto& o) { return !o.problems.empty(); }},
            {"--integrator", 0, lacks::models, [](const auto& o) { return !o.integrators.empty(); }},
            {"--steps", 0, lacks::steps, [](const auto& o) { return !o.steps.empty(); }},
            {"--end", 0, lacks::end, [](const auto& o) { return o.end.has_value(); }},
            {"--set", 0, lacks::models, [](const auto& o) { return !o.set.empty(); }},
            {"--reference", takes::reference, 0, [](const auto& o) { return !o.reference.empty(); }},
            {"--reference-step", takes::reference, 0,
             [](const auto& o) { return o.reference_step.has_value(); }},
            {"--reference-rtol", takes::reference, 0,
             [](const auto& o) { return o.reference_rtol.has_value(); }},
            {"--rtols", takes::rtols, 0, [](const auto& o) { return !o.rtols.empty(); }},
            {"--repeats", takes::repeats, 0, [](const auto& o) { return o.repeats > 0; }},
            {"--bars", takes::bars, 0, [](const auto& o) { return !o.bars.empty(); }},
            {"--preset", takes::preset, 0, [](const auto& o) { return !o.preset.empty(); }},
            {"--normal-rows", takes::normal_rows, 0, [](const auto& o) { return !o.normal_rows.empty(); }},
            {"--against", takes::against, 0, [](const auto& o) { return !o.against.empty(); }},
            {"--check", takes::check, 0, [](const auto& o) { return o.check; }},
            {"--strict", takes::strict, 0, [](const auto& o) { return o.strict; }},
            {"--all", takes::all, 0, [](const auto& o) { return o.all; }},
            {"--grid", takes::grid, 0, [](const auto& o) { return !o.grid.empty(); }},
            {"--vtk", takes::vtk, 0, [](const auto& o) { return o.vtk > 0; }},
            {"--fix-initial", 0, lacks::models, [](const auto& o) { return o.fix_initial; }},
            {"--sweep", takes::sweep, 0, [](const auto& o) { return !o.sweep.empty(); }},
            {"--observable", takes::sweep, 0, [](const auto& o) { return !o.observable.empty(); }},
            {"--keep", takes::sweep, 0, [](const auto& o) { return o.keep; }},
            {"--format", takes::sweep, 0, [](const auto& o) { return !o.format.empty(); }},
            {"--seed", takes::seed, 0, [](const auto& o) { return o.seed.has_value(); }},
            {"--shard", takes::shard, 0, [](const auto& o) { return o.shard.is_part(); }}};
        for (const run::SettingOption& setting : run::setting_options())
            some.push_back({setting.name, studies_with(setting.name), lacks::models,
                            [name = setting.name](const StudyOptions& o) {
                                const auto& given = o.given_settings;
                                return std::find(given.begin(), given.end(), name) != given.end();
                            }});
        return some;
    }();
    return all;
}

/// Rejects options that the study does not use; the message names the studies that use them.
void reject_unused_options(const Study& study, const StudyOptions& options)
{
    for (const OptionOfSome& option : options_of_some()) {
        if (!option.given(options) || has(study, option)) continue;
        const bool of_models = ((option.lacking & lacks::models) != 0 || option.name == "--problem") &&
                               (study.lacking & lacks::models) != 0;
        // the study itself refuses with the option to use instead
        if (option.name == "--problem" && !of_models) continue;
        std::string those;
        for (const Study& other : studies())
            if (has(other, option)) those += (those.empty() ? "" : ", ") + other.name;
        throw io::UsageError("study " + study.name + ": " + option.name + " is for " +
                             (of_models ? "studies of models; this study defines its own bodies"
                                        : (those.empty() ? "other studies" : those)));
    }
}

}  // namespace

const Study& find_study(const std::string& kind)
{
    std::vector<std::string> known;
    for (const Study& study : studies()) {
        if (study.name == kind) return study;
        known.push_back(study.name);
    }
    if (kind.starts_with("granular-")) run::grains("study " + kind);  // says what is missing
    throw io::UsageError("study: unknown study" + with_nearest(kind, known) + " (hilda study lists them)");
}

bool takes_option(const Study& study, const std::string& option)
{
    const std::vector<OptionOfSome>& all = options_of_some();
    return std::all_of(all.begin(), all.end(),
                       [&](const OptionOfSome& some) { return some.name != option || has(study, some); });
}

namespace {

/// Completes the options by defaults. io::UsageError for options that exclude each other.
void complete(StudyOptions& options, const Study& study)
{
    const std::string& kind = study.name;
    reject_unused_options(study, options);
    const bool timed =
        (study.accepted & takes::repeats) != 0;  // concurrent runs would disturb the measurement
    if (timed && options.repeats == 0) options.repeats = 5;
    if (options.jobs == 0)
        options.jobs = timed ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    if (options.output.empty() && !options.json)
        options.output =
            "out/" + kind +
            (options.shard.is_part() ? fmt::format("-{}-of-{}", options.shard.index, options.shard.count)
                                     : "");
    if (options.shard.is_part() && options.output.empty())
        throw io::UsageError("study " + kind + ": --shard writes a file: with --json it needs --output");
    if (!options.figure_formats.empty() && (!options.plot || options.output.empty()))
        throw io::UsageError("study " + kind + ": --figure-format is for figures; " +
                             (options.plot ? "with --json they need --output" : "--no-plot draws none"));
    if (options.latex && options.output.empty())
        throw io::UsageError("study " + kind + ": --latex writes a file: with --json it needs --output");
    if (options.resume && options.output.empty())
        throw io::UsageError("study " + kind + ": --resume needs the --output of the interrupted study");
    if (options.resume && options.force)
        throw io::UsageError("study " + kind + ": --force and --resume exclude each other");
}

int run_here(const Study& study, const StudyOptions& options, const run::JobRecords* collected)
{
    std::optional<io::OutputLock> lock;
    if (!options.output.empty()) {
        io::check_output_directory(
            options.output, options.force || options.resume,
            run::FinishedJobs::in(options.output) ? io::force_or_resume : io::force_overwrites);
        lock.emplace(options.output).create();
    }
    const io::EndOnSignal end_on_signal(options.output.empty() || collected != nullptr
                                            ? ""
                                            : "interrupted; the finished runs are kept in " + options.output +
                                                  ", the same command with --resume continues");
    std::optional<StudyContext> context;
    try {
        context.emplace(study, options, collected);
        study.run(*context);
        return context->finish();
    } catch (const run::PartDone&) {
        return context->finish_shard();
    } catch (...) {
        context.reset();
        if (!options.output.empty())
            rmdir(options.output.c_str());  // fails, as intended, if the directory is not empty
        throw;
    }
}

}  // namespace

int run_study(const std::string& kind, StudyOptions options)
{
    const Study& study = find_study(kind);
    complete(options, study);
    if (const int ranks = run::ranks_of_environment(); ranks > 1 && !options.shard.is_part())
        throw io::UsageError(
            fmt::format("study {}: each of the {} processes of mpirun would compute the whole "
                        "study; use --shard I/N and hilda collect",
                        kind, ranks));
    return run_here(study, options, nullptr);
}

int run_collected(const std::string& kind, StudyOptions options, const run::JobRecords& collected)
{
    const Study& study = find_study(kind);
    complete(options, study);
    return run_here(study, options, &collected);
}

}  // namespace hilda::studies
