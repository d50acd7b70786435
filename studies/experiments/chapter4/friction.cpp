// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction experiments (Fang 2022, Sec. 4.4) with their acceptance criteria.
///
/// An experiment consists of a few runs of one body in contact. The table lists each measured value, the
/// required value and the tolerance. NAME.csv contains the curves of experiment NAME, reduced to at most 2000
/// rows per run. Some experiments have snapshots at the times of the dissertation: NAME-poses.csv,
/// NAME-contacts.csv and NAME-shapes.json (SnapshotTables).
///
/// --against FILE compares every step of the runs with the columns of a table. --check adds the runs that
/// only the criteria need, and returns exit code 6 if a criterion fails.

#include "run/frames/tables.hpp"
#include "studies/experiments/chapter4/friction/experiment.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/published.hpp"
#include "studies/framework/study_options.hpp"

#include "io/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using namespace friction;

constexpr size_t max_rows = 2000;  // limit on the rows per run in NAME.csv
constexpr int path_points = 301;   // frames of a run with snapshots, for the path of its contact point

/// A selected experiment with its runs and their results
struct SelectedExperiment {
    const Experiment* experiment = nullptr;
    std::vector<ExperimentRun> runs = {};
    std::vector<Curve> curves = {};
    std::vector<std::string> failures = {};
    std::vector<run::SnapshotTables> snapshots = {};

    bool has_snapshots() const
    {
        return std::any_of(runs.begin(), runs.end(),
                           [](const ExperimentRun& run) { return !run.snapshots.empty(); });
    }
};

std::vector<SelectedExperiment> selected(const StudyContext& s)
{
    std::vector<SelectedExperiment> all;
    for (const Experiment* e : selected_parts(s, "experiment", experiments())) {
        SelectedExperiment& c = all.emplace_back(SelectedExperiment{.experiment = e, .runs = e->runs});
        std::erase_if(c.runs, [&](const ExperimentRun& run) { return run.check_only && !s.check; });
        c.curves.resize(c.runs.size());
        c.failures.resize(c.runs.size());
        c.snapshots.resize(c.runs.size());
    }
    if (s.options.vtk > 0 && std::none_of(all.begin(), all.end(), [](const SelectedExperiment& c) {
            return c.experiment->has_frames;
        })) {
        std::string names;
        for (const Experiment& e : experiments())
            if (e.has_frames) names += (names.empty() ? "" : ", ") + e.name;
        s.refuse("--vtk is available for " + names);
    }
    return all;
}

/// The curves of all runs. The runs of an experiment may record different columns; the header is that of the
/// first.
std::string curves(const SelectedExperiment& c)
{
    const auto first =
        std::find_if(c.curves.begin(), c.curves.end(), [](const Curve& k) { return k.rows() > 0; });
    CurveTable table({"run"}, first == c.curves.end() ? std::vector<std::string>() : first->columns);
    for (size_t r = 0; r < c.runs.size(); ++r) table.add({c.runs[r].name}, c.curves[r], max_rows);
    return table.csv();
}

/// A criterion of an experiment with its measured value
struct Checked {
    const Experiment* experiment;
    Expected expected;
    double measured = std::nan("");

    bool passed() const { return std::abs(measured - expected.required) <= expected.tolerance; }
};
const Columns<Checked> columns = {
    {"experiment", [](const Checked& k) { return k.experiment->name; }},
    {"figure", [](const Checked& k) { return k.experiment->figure; }},
    {"what", "what", [](const Checked& k) { return k.expected.what; }},
    {"measured", "measured", "{:.8g}", &Checked::measured},
    {"required", "required", "{:.8g}", [](const Checked& k) { return k.expected.required; }},
    {"tolerance", "+-", "{:.1e}", [](const Checked& k) { return k.expected.tolerance; }},
    {"by", "by", [](const Checked& k) { return k.expected.source; }},
    {"passed", "passed", [](const Checked& k) { return k.passed() ? "yes" : "NO"; }}};

/// Evaluates the criteria of an experiment. A run that failed is a criterion that failed.
std::vector<Checked> checked(const SelectedExperiment& c)
{
    std::vector<Checked> all;
    for (const Expected& k : c.experiment->expected) {
        if (k.run.empty()) all.push_back({c.experiment, k, k.measure({})});
        for (size_t r = 0; r < c.runs.size(); ++r)
            if (c.runs[r].name == k.run && c.curves[r].rows() > 0)
                all.push_back({c.experiment, k, k.measure(c.curves[r])});
    }
    for (size_t r = 0; r < c.runs.size(); ++r)
        if (!c.failures[r].empty())
            all.push_back(
                {c.experiment,
                 {.what = "run " + c.runs[r].name + " ends", .source = "failed: " + c.failures[r]}});
    return all;
}

/// Computes one run of an experiment and writes its frames.
void compute(SelectedExperiment& c, size_t r, const StudyOptions& options)
{
    const std::string name = c.experiment->name + '-' + c.runs[r].name;
    if (options.force && !options.output.empty()) run::Snapshots::remove(options.output, name);
    const BodyOnPlane setup = c.runs[r].setup();
    const std::vector<double>& times = c.runs[r].snapshots;
    std::vector<Frames> frames;
    if (!times.empty()) frames.push_back({.count = path_points, .times = times});
    const bool with_frames = options.vtk > 0 && c.experiment->has_frames;
    if (with_frames) frames.push_back({.count = options.vtk});
    try {
        c.curves[r] = simulate(setup, frames);
    } catch (const io::NumericalFailure& e) {
        c.failures[r] = e.what();
    }
    if (with_frames) frames.back().snapshots.write(options.output, name);
    if (!times.empty())
        c.snapshots[r] = run::snapshot_tables(frames.front().snapshots, c.runs[r].name, {setup.name, "plane"},
                                              {setup.name}, times);
}

void friction_experiments(StudyContext& s)
{
    const StudyOptions& options = s.options;
    if (!options.expect.empty() && options.against.empty())
        s.refuse("--expect difference needs --against FILE");
    std::vector<SelectedExperiment> all = selected(s);
    std::vector<std::pair<SelectedExperiment*, size_t>> jobs;
    for (SelectedExperiment& c : all)
        for (size_t r = 0; r < c.runs.size(); ++r) jobs.emplace_back(&c, r);
    s.pool(jobs.size())
        .run([&](long k) { compute(*jobs[k].first, jobs[k].second, options); },
             [&](io::Archive& a, long k) {
                 const auto& [c, r] = jobs[k];
                 c->curves[r].transfer(a), a.list(c->failures[r]), c->snapshots[r].transfer(a);
             });

    std::vector<Checked> checks;
    std::vector<NamedCurve> named;
    io::Json rows = io::Json::array();
    std::string frames;
    for (const SelectedExperiment& c : all) {
        const Experiment& e = *c.experiment;
        s.text << fmt::format("\n{}{}: {}\n", e.name, e.figure.empty() ? "" : " (Fig. " + e.figure + ")",
                              e.what);
        const std::vector<Checked> of_this = checked(c);
        if (!of_this.empty())
            columns.print(s.text, of_this, {"measured", "required", "tolerance", "passed", "by", "what"});
        for (const Checked& k : of_this) {
            io::Json row = columns.json(k, {"experiment", "what", "measured", "required", "tolerance", "by"});
            row["passed"] = k.passed();
            rows.push_back(row);
            checks.push_back(k);
        }
        s.files.emplace_back(e.name + ".csv", curves(c));
        s.figures.push_back(fmt::format("{}-{}.png", s.name, e.name));
        if (c.has_snapshots()) {
            for (auto& file : run::snapshot_files(e.name + '-', c.snapshots))
                s.files.push_back(std::move(file));
            s.figures.push_back(fmt::format("{}-{}-snapshots.png", s.name, e.name));
        }
        for (size_t r = 0; r < c.runs.size(); ++r) named.push_back({e.name, c.runs[r].name, &c.curves[r]});
        if (options.vtk > 0 && e.has_frames)
            frames += fmt::format("\nframes for ParaView: {}/{}-*.pvd", options.output, e.name);
    }
    const auto passed = static_cast<size_t>(
        std::count_if(checks.begin(), checks.end(), [](const Checked& k) { return k.passed(); }));
    s.criteria_passed = passed == checks.size();
    s.text << fmt::format("\n{} of {} criteria passed{}\n", passed, checks.size(),
                          options.check ? "" : "; --check adds the long runs and their criteria");
    if (!options.against.empty()) compare_with_published(s, named);
    if (options.vtk > 0) s.text << frames << '\n';
    s.table = columns.csv(checks);
    s.json = {{"criteria", checks.size()}, {"passed", passed}, {"checks", rows}};
}

const bool registered_friction = io::Registry<Study>::add(
    {.name = "friction",
     .answers =
         "sliding, rolling and spinning friction: experiments and acceptance criteria (Figs. 4.6, 4.7, "
         "4.9-4.12, 4.14-4.18, Table 4.7)",
     .options = {"--problem", "--against", "--check", "--vtk", "--shard"},
     .keys = {"difference"},
     .files = {"EXPERIMENT.csv", "EXPERIMENT-poses.csv", "EXPERIMENT-contacts.csv", "EXPERIMENT-shapes.json",
               "friction-EXPERIMENT.png", "friction-EXPERIMENT-snapshots.png"},
     .run = friction_experiments});

}  // namespace

}  // namespace hilda::studies
