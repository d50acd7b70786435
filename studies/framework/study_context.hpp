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

using Schemes = std::vector<const lie::Scheme*>;

/// Results of one part of a study, by the keys of --expect
struct Measured {
    std::string of;  ///< for messages: "rA-half-1 on double_pendulum"
    std::map<std::string, double> value;
};

class StudyContext {
public:
    /// Opens the file of the finished jobs in the output directory. io::UsageError for a key of --expect that
    /// the study does not have, for --vtk without a directory, and for --resume with other options than the
    /// interrupted study.
    ///
    /// `collected`: the results of all runs, from shards; nullptr: they are computed.
    StudyContext(const Study& study, const StudyOptions& options, const run::JobRecords* collected = nullptr);

    const std::string& name;
    const std::vector<std::string>& keys;  ///< of --expect
    const StudyOptions& options;

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

    /// Prints the text, writes the files and draws the figures. Returns the exit code: 4 if all runs failed
    /// (or one, see every_run_must_succeed), 6 if an expectation or, with --check, a criterion failed. The
    /// common keys of study.json are study, tolerance, settings, seed, set, provenance and, if
    /// options.repeats > 0, repeats.
    int finish();
    /// The end of one of several shards: its results are complete for hilda collect. Returns the exit code.
    int finish_shard();

private:
    io::Json whole() const;
    void write(const io::Json& whole_json) const;
    bool as_expected() const;

    std::string latex_tables() const;

    const std::string& answers;  ///< of the study
    std::string failed_runs,
        numerical_failure;  ///< texts; empty if no run failed, or not enough for exit code 4
    std::unique_ptr<run::FinishedJobs> finished;  ///< nullptr without an output directory
    std::unique_ptr<run::JobSharing> sharing;     ///< of the pools
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
    const std::vector<std::string>& names = study.options.problems;
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
/// the friction laws, and the grid
template <class Grid>
struct GridOptions {
    double h, end;
    std::string preset;
    const Grid& grid;

    bool dissertation() const { return preset == "dissertation"; }
};
/// These options, with defaults; the defaults of --preset and --grid are `dissertation` and the first grid.
/// They become the first keys of study.json.
template <class Grid>
GridOptions<Grid> grid_options(StudyContext& s, double h, double end, const std::vector<Grid>& grids)
{
    GridOptions<Grid> o{s.one_step(h), s.options.end.value_or(end),
                        s.options.preset.empty() ? "dissertation" : s.options.preset,
                        one_of_list("--grid", s.options.grid, grids)};
    s.json = {{"preset", o.preset}, {"h", o.h}, {"end", o.end}, {"grid", o.grid.name}};
    return o;
}

}  // namespace hilda::studies
