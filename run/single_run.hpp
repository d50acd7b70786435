// SPDX-License-Identifier: GPL-3.0-or-later
/// The simulation of one model with one integrator, and its output directory.

#pragma once

#include "dae/model_file.hpp"
#include "io/resumable.hpp"
#include "lie/schemes.hpp"
#include "run/earlier_run.hpp"
#include "run/recording/recorder.hpp"
#include "run/run_options.hpp"
#include "run/simulation.hpp"
#include "run/summary.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hilda::run {

class SingleRun : private io::Resumable {
public:
    /// Options and scheme must outlive this object. The scheme is another one if the options choose that of
    /// the model.
    SingleRun(const RunOptions& options, const lie::Scheme& scheme, std::string directory);

    /// Reads the model, integrates, writes the files and returns the result. A numerical failure or an
    /// interruption is reported in the result. All other errors are thrown: lie::InvalidInput and
    /// io::UsageError before any file is written, io::IoError.
    RunResult execute();

private:
    bool read() override;
    void restore(const std::string& bytes, const std::string& file) override;
    void check() override;
    void clear() override;
    void open() override;
    bool at_end() const override;
    bool next_step() override;
    void end() override;
    void failed(const io::NumericalFailure& failure) override;
    void close() override;
    std::string summary() override;

    double time() const override;
    void show(io::ProgressLine& on, Clock::time_point now) const override;
    void before_save() override;
    void write(const io::Append& append) override;
    bool can_be_resumed() const override { return scheme->resumes; }
    bool can_be_extended() const override { return !final_checkpoint.empty(); }

    void prepare_coupling();
    void refuse_events() const;
    void make_simulation();
    /// The text of model.json
    std::string text_of_model() const;
    std::string checkpoint();
    void add_warning(const std::string& what);
    std::vector<std::string> files_of_run();

    const RunOptions& options;
    const lie::Scheme* scheme;
    const std::string directory;
    dae::Description description;
    lie::TimeGrid grid;
    EarlierRun earlier;
    RunSettings settings;
    std::shared_ptr<RunTables> tables;
    std::optional<Simulation> simulation;
    std::optional<Recorder> recorder;
    std::optional<RefinedRuns> refined;  ///< of --error
    /// Before the last node is written; empty if the run did not reach its end
    std::string final_checkpoint;
    double earlier_seconds = 0;  ///< wall time before the checkpoint [s]
    RunResult result;
};

}  // namespace hilda::run
