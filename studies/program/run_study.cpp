// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/run_study.hpp"

#include "io/files.hpp"
#include "io/program.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/program/arguments.hpp"

#include <unistd.h>

#include <algorithm>
#include <thread>

namespace hilda::studies {

namespace {

const Study& find(const std::string& kind)
{
    std::vector<std::string> known;
    for (const Study& study : studies()) {
        if (study.name == kind) return study;
        known.push_back(study.name);
    }
    throw io::UsageError("study: unknown study" + with_nearest(kind, known) + " (hilda study lists them)");
}

/// Rejects options that the study does not use; the message names the studies that use them.
void reject_unused_options(const Study& study, const StudyOptions& options)
{
    const auto reject_if = [&](bool given, unsigned option, const std::string& name) {
        if (!given || (study.accepted & option) != 0) return;
        std::string those;
        for (const Study& other : studies())
            if ((other.accepted & option) != 0) those += (those.empty() ? "" : ", ") + other.name;
        throw io::UsageError("study " + study.name + ": " + name + " is for " +
                             (those.empty() ? "other studies" : those));
    };
    reject_if(!options.reference.empty(), takes::reference, "--reference");
    reject_if(options.reference_step.has_value(), takes::reference, "--reference-step");
    reject_if(options.reference_rtol.has_value(), takes::reference, "--reference-rtol");
    reject_if(!options.rtols.empty(), takes::rtols, "--rtols");
    reject_if(options.repeats > 0, takes::repeats, "--repeats");
    reject_if(!options.bars.empty(), takes::bars, "--bars");
    reject_if(!options.preset.empty(), takes::preset, "--preset");
    reject_if(!options.normal_rows.empty(), takes::normal_rows, "--normal-rows");
    reject_if(!options.against.empty(), takes::against, "--against");
    reject_if(options.check, takes::check, "--check");
    reject_if(options.all, takes::all, "--all");
    reject_if(!options.grid.empty(), takes::grid, "--grid");
    reject_if(options.vtk > 0, takes::vtk, "--vtk");
    reject_if(!options.sweep.empty(), takes::sweep, "--sweep");
    reject_if(!options.observable.empty(), takes::sweep, "--observable");
    reject_if(options.keep, takes::sweep, "--keep");
}

}  // namespace

int run_study(const std::string& kind, StudyOptions options)
{
    const Study& study = find(kind);
    reject_unused_options(study, options);
    const bool timed =
        (study.accepted & takes::repeats) != 0;  // concurrent runs would disturb the measurement
    if (timed && options.repeats == 0) options.repeats = 5;
    if (options.jobs == 0)
        options.jobs = timed ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    if (options.output.empty() && !options.json) options.output = "out/" + kind;
    if (!options.figure_formats.empty() && (!options.plot || options.output.empty()))
        throw io::UsageError("study " + kind + ": --figure-format is for figures; " +
                             (options.plot ? "with --json they need --output" : "--no-plot draws none"));
    if (options.resume && options.output.empty())
        throw io::UsageError("study " + kind + ": --resume needs the --output of the interrupted study");
    if (options.resume && options.force)
        throw io::UsageError("study " + kind + ": --force and --resume exclude each other");
    if (!options.output.empty()) {
        io::check_output_directory(
            options.output, options.force || options.resume,
            FinishedJobs::in(options.output) ? io::force_or_resume : io::force_overwrites);
        io::make_directory(options.output);
    }
    const io::EndOnSignal end_on_signal(options.output.empty()
                                            ? ""
                                            : "interrupted; the finished runs are kept in " + options.output +
                                                  ", the same command with --resume continues");
    try {
        StudyContext context(study, options);
        study.run(context);
        return context.finish();
    } catch (...) {
        if (!options.output.empty())
            rmdir(options.output.c_str());  // fails, as intended, if the directory is not empty
        throw;
    }
}

}  // namespace hilda::studies
