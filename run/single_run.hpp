// SPDX-License-Identifier: GPL-3.0-or-later
/// The simulation of one model with one integrator, and its output directory.

#pragma once

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/program.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"
#include "run/progress.hpp"
#include "run/recording/checkpoint.hpp"
#include "run/recording/recorder.hpp"
#include "run/run_options.hpp"
#include "run/simulation.hpp"
#include "run/summary.hpp"

#include <optional>
#include <string>

namespace hilda::run {

/// --resume in the directory of a run that has ended, without a later end
struct RunHasEnded : io::UsageError {
    using UsageError::UsageError;
};

class SingleRun : private io::Verbosity {
public:
    /// Options and scheme must outlive this object.
    SingleRun(const RunOptions& options, const lie::Scheme& scheme, std::string directory);

    /// Reads the model, integrates, writes the files and returns the result. A numerical failure or an
    /// interruption is reported in the result. All other errors are thrown: lie::InvalidInput and
    /// io::UsageError before any file is written, io::IoError.
    RunResult execute();

private:
    using Clock = std::chrono::steady_clock;

    void read();
    void load_checkpoint();
    /// io::UsageError if the checkpoint is from another run, or if this run does not end after it
    void check_continues() const;
    void refuse_events() const;
    void clear_directory() const;
    RunSettings settings_of_run();
    /// The text of model.json
    std::string text_of_model() const;
    class Loop;
    void march(Simulation& simulation, Recorder& recorder);
    void ended(Simulation& simulation, Recorder& recorder);
    std::string checkpoint(Simulation& simulation, Recorder& recorder) const;
    void save_checkpoint(Simulation& simulation, Recorder& recorder);
    void add_warning(const std::string& what);
    void check_contacts();
    void finish(Simulation& simulation, const Recorder& recorder);

    std::string path(const std::string& file) const { return directory + '/' + file; }

    const RunOptions& options;
    const lie::Scheme& scheme;
    const std::string directory;
    dae::Description description;
    lie::TimeGrid grid;
    RunSettings settings;
    std::optional<Checkpoint> from;  ///< of a resumed run
    std::string from_file;
    bool extends = false;  ///< continues a run that has ended
    std::string
        final_checkpoint;  ///< before the last node is written; empty if the run did not reach its end
    Clock::time_point begin;
    double earlier_seconds = 0;  ///< wall time before the checkpoint [s]
    RunResult result;
};

}  // namespace hilda::run
