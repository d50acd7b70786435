// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/run_study.hpp"

#include "studies/output.hpp"
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
        if (study.kind == kind) return study;
        known.push_back(study.kind);
    }
    throw UsageError("study: unknown study" + with_nearest(kind, known) + " (hilda study lists them)");
}

/// An option that a study would not look at is a mistake of the one who gave it.
void refuse_idle_options(const Study& study, const StudyOptions& options)
{
    const auto idle = [&](bool given, unsigned option, const std::string& name) {
        if (!given || (study.also & option) != 0) return;
        std::string those;
        for (const Study& other : studies())
            if ((other.also & option) != 0) those += (those.empty() ? "" : ", ") + other.kind;
        throw UsageError("study " + study.kind + ": " + name + " is for " +
                         (those.empty() ? "other studies" : those));
    };
    idle(!options.reference.empty(), takes::reference, "--reference");
    idle(options.reference_step.has_value(), takes::reference, "--reference-step");
    idle(options.reference_rtol.has_value(), takes::reference, "--reference-rtol");
    idle(!options.rtols.empty(), takes::rtols, "--rtols");
    idle(options.repeats > 0, takes::repeats, "--repeats");
    idle(!options.bars.empty(), takes::bars, "--bars");
    idle(!options.preset.empty(), takes::preset, "--preset");
    idle(!options.normal_rows.empty(), takes::normal_rows, "--normal-rows");
    idle(!options.against.empty(), takes::against, "--against");
    idle(options.check, takes::check, "--check");
    idle(!options.grid.empty(), takes::grid, "--grid");
    idle(options.vtk > 0, takes::vtk, "--vtk");
}

}  // namespace

int run_study(const std::string& kind, StudyOptions options)
{
    const Study& study = find(kind);
    refuse_idle_options(study, options);
    const bool timed = (study.also & takes::repeats) != 0;  // side by side, runs would slow each other down
    if (timed && options.repeats == 0) options.repeats = 5;
    if (options.jobs == 0)
        options.jobs = timed ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    if (options.output.empty() && !options.json) options.output = "out/" + kind;
    if (!options.output.empty()) {
        if (!is_vacant(options.output) && !options.force)
            throw UsageError(options.output + ": is not empty; --force overwrites");
        make_directory(options.output);
    }
    try {
        return study.run(options);
    } catch (...) {
        if (!options.output.empty())
            rmdir(options.output.c_str());  // leaves it alone when there is something in it
        throw;
    }
}

}  // namespace hilda::studies
