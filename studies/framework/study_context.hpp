// SPDX-License-Identifier: GPL-3.0-or-later
/// What a study receives when it runs: its options, its selection of benchmarks, integrators and steps, and
/// the place for its results.

#pragma once

#include "io/json.hpp"
#include "io/option_values.hpp"
#include "run/jobs/finished_jobs.hpp"
#include "run/jobs/pool.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/study.hpp"
#include "studies/framework/table.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

namespace hilda::studies {

struct StudyOptions;

using Schemes = std::vector<const lie::Scheme*>;

/// Results of one part of a study, by the keys of --expect
struct Measured {
    std::string of;  ///< for messages: "rA-half-1 on double_pendulum"
    std::map<std::string, double> value;
};

class StudyContext {
public:
    /// `finished`: keeps the results of jobs; nullptr: none are kept. All arguments must outlive this object.
    StudyContext(const Study& study, const StudyOptions& options, run::FinishedJobs* finished = nullptr);

    const std::string& name;
    const std::vector<std::string>& keys;  ///< of --expect

    // Options that many studies read; the others are in `options`.
    const StudyOptions& options;
    const lie::Settings& settings;
    const std::vector<std::string>& problems;  ///< of --problem
    const std::vector<std::string>& set;       ///< /json/pointer=VALUE
    const std::string& output;                 ///< existing output directory; "": no files
    const std::string& against;                ///< a CSV file to compare with; "": none
    const std::string& grid;                   ///< name of a parameter grid; "": the default
    const int jobs_at_once, repeats;           ///< of --jobs and --repeats
    const bool check, quiet;

    /// Whether the command line has the option with this name
    bool is_given(const std::string& option) const;

    /// io::UsageError "study NAME: what"
    [[noreturn]] void refuse(const std::string& what) const;

    /// The integrators of --integrator; without it those of `defaults` that are registered, in this order, or
    /// all if `defaults` is empty. A scheme with both forms has adaptive steps if --rtol or --atol is given.
    Schemes schemes(const std::vector<std::string>& defaults = {}) const;
    /// The same, restricted to schemes with a fixed step. io::UsageError if --integrator names an adaptive
    /// scheme.
    Schemes fixed_step_schemes(const std::vector<std::string>& defaults = {}) const;
    /// The steps of --steps, or `defaults`, in descending order [s]
    std::vector<double> steps(const std::vector<double>& defaults) const;
    /// The step of --steps, or the default [s]. io::UsageError for more than one step.
    double one_step(double defaults) const;
    /// The benchmarks of --problem or of `defaults`. io::UsageError for a step that check_steps rejects.
    std::vector<Benchmark> benchmarks(const std::vector<std::string>& defaults,
                                      const std::vector<double>& steps,
                                      const DefaultEnd& end = end_of_model) const;
    /// A pool with this number of threads, or that of --jobs. Its progress line shows the name of the study
    /// and the label. The results of its jobs are kept in the file of the finished jobs.
    run::Pool pool(size_t jobs, const std::string& label = "", int threads = 0) const;
    /// Calls job(), on this thread and without a progress line, in each shard. `transfer`
    /// writes or reads its result, which is kept in the file of the finished jobs: a job that finished before
    /// the study was interrupted is not called again.
    void job(const std::function<void()>& job, const std::function<void(io::Archive&)>& transfer) const;
    /// Calls job(0) … job(count - 1), which do not depend on each other, one after the other on this thread
    /// and without a progress line; shards share them. See job() for `transfer`.
    void jobs(long count, const std::function<void(long)>& job, const run::Pool::Transfer& transfer) const;

    // Results
    StudyText text;                                          ///< for stdout
    std::string table;                                       ///< contents of study.csv
    io::Json json = io::Json::object();                      ///< of study.json, after the common keys
    std::vector<std::pair<std::string, std::string>> files;  ///< further files: name and contents
    std::vector<std::string> figures;                        ///< files that plots/NAME.py draws
    std::vector<Measured> measured;                          ///< compared with --expect
    bool criteria_passed = true;                             ///< set by evaluate()
    bool every_run_must_succeed = false;  ///< exit code 4 if one run fails, not only if all do

    /// study.csv of runs, and their values of the columns that are keys of --expect
    template <class Columns, class Runs>
    void results(const Columns& columns, const Runs& all)
    {
        table = columns.csv(all);
        end_of_runs(run_pointers(all));
        for (const auto& run : all) measured.push_back({run.name(), columns.numbers(run, keys)});
    }
    /// Adds values by their keys of --expect. Returns them as a JSON object, for study.json.
    io::Json measure(const std::string& of, const std::vector<std::pair<std::string, double>>& values);
    /// Records which runs failed or have warnings. If all of them failed, so has the study (see
    /// every_run_must_succeed).
    void end_of_runs(const std::vector<const Run*>& runs);
    /// A warning of the watch over a run. With --strict the exit code is 4, and the first warning is its
    /// reason.
    void warned(const std::string& warning, const std::string& text);
    /// Prints the acceptance criteria and adds them to study.json. With --check the study fails if one fails.
    void evaluate(const std::vector<Criterion>& criteria);

    // Failures, as texts; empty if no run failed, or not enough for exit code 4
    std::string failed_runs;        ///< for stdout
    std::string numerical_failure;  ///< for stderr

private:
    run::FinishedJobs* const finished;
    const std::unique_ptr<run::JobSharing> sharing;  ///< of the pools
};

/// io::UsageError "study NAME: unknown WHAT 'x'; did you mean ...?" for a name of --problem that is not known
void check_parts(const StudyContext& study, const std::string& what, const std::vector<std::string>& known);

/// The entries of a list that --problem selects, by their member `name`; all without --problem.
/// io::UsageError for an unknown name.
template <class Part>
std::vector<const Part*> selected_parts(const StudyContext& study, const std::string& what,
                                        const std::vector<Part>& parts)
{
    std::vector<std::string> known;
    for (const Part& part : parts) known.push_back(part.name);
    check_parts(study, what, known);
    std::vector<const Part*> selected;
    const std::vector<std::string>& names = study.problems;
    for (const Part& part : parts)
        if (names.empty() || std::find(names.begin(), names.end(), part.name) != names.end())
            selected.push_back(&part);
    return selected;
}

/// The entry of a list with this name, an argument of an option such as --grid; the first entry for "".
/// io::UsageError for another name.
template <class Named>
const Named& one_of_list(const std::string& option, const std::string& name, const std::vector<Named>& list)
{
    std::vector<std::string> known;
    for (const Named& entry : list) known.push_back(entry.name);
    if (!name.empty()) io::one_of(option, name, known);
    const auto at = std::find(known.begin(), known.end(), name);
    return name.empty() ? list.front() : list[static_cast<size_t>(at - known.begin())];
}

/// Options of a study of scenes over a grid of parameters: the step h and the end of a run [s], the preset of
/// the friction laws
struct SceneOptions {
    double h, end;
    std::string preset;

    bool dissertation() const { return preset == "dissertation"; }
};
/// These options, with defaults; the default of --preset is `dissertation`. With the name of the grid they
/// become the first keys of study.json.
SceneOptions scene_options(StudyContext& s, double h, double end, const std::string& grid);

/// The same and the grid, by default the first one
template <class Grid>
struct GridOptions : SceneOptions {
    const Grid& grid;
};
template <class Grid>
GridOptions<Grid> grid_options(StudyContext& s, double h, double end, const std::vector<Grid>& grids)
{
    const Grid& grid = one_of_list("--grid", s.grid, grids);
    return {scene_options(s, h, end, grid.name), grid};
}

}  // namespace hilda::studies
