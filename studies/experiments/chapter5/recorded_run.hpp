// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs of variants of a model that record a curve, write frames for ParaView (--vtk N), and may be repeated
/// with half of the step for the acceptance criteria.

#pragma once

#include "dae/model_file.hpp"
#include "run/frames/model_frames.hpp"
#include "studies/framework/curve.hpp"
#include "studies/framework/study_options.hpp"
#include "studies/framework/sweep.hpp"

#include <optional>

namespace hilda::studies {

/// The scheme of the dissertation and the recommended one
inline const std::string dissertation_scheme = "rA-half-1", recommended_scheme = "rA-half-1-momentum";

template <class Variant>
struct RecordedRun : Run {
    const Variant* variant = nullptr;
    bool for_check = false;  ///< with half of the step, only for the acceptance criteria
    Curve curve = {};        ///< a row for each node

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        curve.transfer(a);
    }

    /// 0: the scheme of the dissertation; 1: the recommended one; 2: any other
    size_t which_scheme() const
    {
        return scheme->name == dissertation_scheme ? 0 : scheme->name == recommended_scheme ? 1 : 2;
    }
};

/// The run with half of the step; nullptr if there is none or if it failed
template <class Row>
const Row* half_step_run(const std::vector<Row>& runs, const Row& run)
{
    const auto half = those(runs, [&](const Row& other) {
        return other.for_check && other.c == run.c && other.scheme == run.scheme;
    });
    return half.empty() || half.front()->failed() ? nullptr : half.front();
}

/// Integrates the run with a Newton tolerance of at most `tolerance`. Frames NAME-*.vtp are written to the
/// directory of the study, except of a run for the criteria; those of an earlier run are removed.
template <class Variant>
void march_with_frames(RecordedRun<Variant>& run, const StudyOptions& options, double tolerance,
                       std::vector<lie::Observer*> observers, const std::string& name)
{
    std::optional<run::ModelFrames> frames;
    if (options.vtk > 0 && !run.for_check) {
        frames.emplace(*run.c->started->model,
                       run::EvenSelection(options.vtk, std::lround(run.c->end / run.h)));
        observers.push_back(&*frames);
    }
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, tolerance);
    march(run, settings, observers);
    if (options.force && !options.output.empty()) run::Snapshots::remove(options.output, name);
    if (frames) frames->snapshots.write(options.output, name);
}

}  // namespace hilda::studies
