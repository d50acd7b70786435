// SPDX-License-Identifier: GPL-3.0-or-later
/// One model, one integrator, one directory.

#pragma once

#include "dae/model_file.hpp"
#include "lie/trajectory.hpp"
#include "studies/program/run_model.hpp"
#include "studies/progress.hpp"
#include "studies/running/checkpoint.hpp"
#include "studies/running/model_frames.hpp"
#include "studies/running/recorder.hpp"
#include "studies/running/summary.hpp"

#include <optional>
#include <string>

namespace hilda::studies {

class SingleRun {
public:
    /// Options and scheme must outlive the run.
    SingleRun(const RunOptions& options, const lie::Scheme& scheme, std::string directory);

    /// Reads the model, marches, writes. A numerical failure and an interruption end up in the result;
    /// everything else that goes wrong is thrown, and before anything is written where it lies in the model
    /// or the options.
    Result go();

    /// The directory holds the summary of a run and nothing to go on from.
    static bool has_ended(const std::string& directory);

private:
    using Clock = std::chrono::steady_clock;

    void read();
    void prepare_frames();
    /// Refuses a step that a force does not stand, or a scheme.
    void evaluate_step(bool resumed) const;
    std::optional<Checkpoint> load_checkpoint() const;
    void clear_directory() const;
    void march(lie::Integrator& integrator, const std::optional<Checkpoint>& from);
    void advance(lie::March& march, lie::Integrator& integrator, Recorder& recorder);
    void save_checkpoint(const lie::March& march, Recorder& recorder);
    void count(const lie::March& march, const Recorder& recorder);
    void evaluate_contacts();
    void failed(const lie::NumericalFailure& failure, const lie::March& march);
    void finish();

    std::string path(const std::string& file) const { return directory + '/' + file; }
    void say(const std::string& what) const;
    void warn(const std::string& what) const;

    const RunOptions& options;
    const lie::Scheme& scheme;
    const std::string directory;
    dae::Description description;
    std::optional<ModelFrames> frames;
    lie::TimeGrid grid;
    std::string settings;
    double last_node = 0;  ///< time of the last node [s]
    Clock::time_point begin;
    double seconds_before = 0;  ///< of a run that is gone on with
    Result result;
};

}  // namespace hilda::studies
