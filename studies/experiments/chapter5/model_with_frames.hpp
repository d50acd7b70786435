// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs of a study that write frames for ParaView (--vtk N).

#pragma once

#include "dae/model_file.hpp"
#include "lie/settings.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/study.hpp"
#include "studies/running/model_frames.hpp"

#include <optional>

namespace hilda::studies {

/// Integrates the run with a Newton tolerance of at most `tolerance`. Frames NAME-*.vtp are written to the directory of
/// the study if `with_frames`; those of an earlier run are removed.
inline void march_with_frames(Run& run, const StudyOptions& options, double tolerance,
                              std::vector<lie::Observer*> observers, const std::string& name,
                              bool with_frames)
{
    std::optional<ModelFrames> frames;
    if (options.vtk > 0 && with_frames) {
        frames.emplace(*run.c->started->model, EvenSelection(options.vtk, std::lround(run.c->end / run.h)));
        observers.push_back(&*frames);
    }
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, tolerance);
    march(run, settings, observers);
    if (options.force && !options.output.empty()) Snapshots::remove(options.output, name);
    if (frames) frames->snapshots.write(options.output, name);
}

}  // namespace hilda::studies
