// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction experiments (Fang 2022, Sec. 4.4) with their acceptance criteria.
///
/// An experiment consists of a few runs of one body in contact. The table lists each measured value, the
/// required value and the tolerance. NAME.csv contains the curves of experiment NAME, reduced to at most 2000
/// rows per run.
///
/// --against FILE compares every step of the runs with the columns of a table. A column "x_damped" is
/// compared with quantity x of run "damped". A column "x" is compared with quantity x of every run, and the
/// run with the smallest difference is marked. --check adds the runs that only the criteria need, and returns
/// exit code 6 if a criterion fails.

#include "io/json.hpp"
#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "io/csv.hpp"
#include "io/error.hpp"
#include "studies/framework/csv_table.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using namespace friction;

const std::string kind = "friction";
constexpr size_t max_rows = 2000;  // limit on the rows per run in NAME.csv

/// A selected experiment with its runs and their results
struct SelectedExperiment {
    const Experiment* experiment = nullptr;
    std::vector<ExperimentRun> runs;
    std::vector<Series> series;
    std::vector<std::string> failures;
    std::vector<Check> checks;
};

std::vector<SelectedExperiment> selected(const StudyOptions& options)
{
    std::vector<std::string> known;
    for (const Experiment& e : experiments()) known.push_back(e.name);
    for (const std::string& name : options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw io::UsageError("study friction: unknown experiment" + with_nearest(name, known));
    std::vector<SelectedExperiment> all;
    for (const Experiment& e : experiments()) {
        const auto& names = options.problems;
        if (!names.empty() && std::find(names.begin(), names.end(), e.name) == names.end()) continue;
        SelectedExperiment c;
        c.experiment = &e, c.runs = e.runs();
        std::erase_if(c.runs, [&](const ExperimentRun& run) { return run.check_only && !options.check; });
        c.series.resize(c.runs.size());
        c.failures.resize(c.runs.size());
        all.push_back(std::move(c));
    }
    return all;
}

/// io::UsageError if --vtk is given and no selected experiment writes frames
void check_vtk(const StudyOptions& options, const std::vector<SelectedExperiment>& all)
{
    if (options.vtk == 0) return;
    studies::check_vtk(kind, options);
    if (std::any_of(all.begin(), all.end(),
                    [](const SelectedExperiment& c) { return c.experiment->has_frames; }))
        return;
    std::string names;
    for (const Experiment& e : experiments())
        if (e.has_frames) names += (names.empty() ? "" : ", ") + e.name;
    throw io::UsageError("study friction: --vtk is available for " + names);
}

std::string curves(const SelectedExperiment& c)
{
    std::string csv = "run";
    for (const Series& s : c.series)
        if (s.rows() > 0) {
            for (const std::string& column : s.columns) csv += ',' + io::csv_field(column);
            break;
        }
    csv += '\n';
    for (size_t r = 0; r < c.runs.size(); ++r) {
        const Series& s = c.series[r];
        const size_t stride = std::max<size_t>(1, (s.rows() + max_rows - 1) / max_rows);
        for (size_t k = 0; k < s.rows(); k += stride) {
            csv += io::csv_field(c.runs[r].name);
            for (size_t column = 0; column < s.columns.size(); ++column) {
                csv += ',';
                io::append_number(csv, s.at(k, column));
            }
            csv += '\n';
        }
    }
    return csv;
}

/// Largest difference of two columns, the time t [s] at which it occurs, and the largest value of the
/// reference column
struct CurveDifference {
    double largest = 0, t = 0, size = 0;
    long shift = 0, rows = 0;

    double relative() const { return size > 0 ? largest / size : largest; }
};

/// Compares rows of equal t. The file may be `shift` rows late and may have the opposite sign convention.
CurveDifference difference(const std::vector<double>& t, const std::vector<double>& reference,
                           const Series& s, size_t column, long shift, double sign)
{
    CurveDifference d{.shift = shift};
    const double h = s.rows() > 1 ? s.at(1, 0) - s.at(0, 0) : 1;
    for (size_t k = 1; k < t.size(); ++k) {  // row 0 is not compared: published runs do not set it
        const long row = std::lround(t[k] / h) - shift;
        if (row < 0 || row >= static_cast<long>(s.rows()) || !std::isfinite(reference[k])) continue;
        if (std::abs(static_cast<double>(row + shift) * h - t[k]) > 1e-6 * h) continue;
        ++d.rows;
        d.size = std::max(d.size, std::abs(reference[k]));
        const double deviation = std::abs(reference[k] - sign * s.at(static_cast<size_t>(row), column));
        if (deviation > d.largest) d.largest = deviation, d.t = t[k];
        if (std::isnan(deviation)) d.largest = INFINITY, d.t = t[k];
    }
    return d;
}

/// Name of the quantity in a column: "x" for column x_damped of run damped and for column x_KE5e6 of run
/// upright-KE5e6; the whole column name otherwise
std::string quantity_of(const std::string& column, const std::string& run)
{
    const size_t at = column.find('_');
    if (at == std::string::npos) return column;
    const std::string suffix = column.substr(at + 1);
    return run == suffix || run.ends_with('-' + suffix) ? column.substr(0, at) : column;
}

/// A column of the file and a run with the same quantity
struct ColumnMatch {
    std::string column, experiment, run;
    CurveDifference difference;
    double sign = 1;
    bool nearest = false;  ///< this run has the smallest difference of all runs with this quantity
};

/// Finds the shift (0 or 1 row) and the sign with the smallest difference.
void find_best_shift(ColumnMatch& m, const std::vector<double>& t, const std::vector<double>& reference,
                     const Series& s, size_t column)
{
    for (const long shift : {0L, 1L})
        for (const double sign : {1., -1.})
            if (const CurveDifference d = difference(t, reference, s, column, shift, sign);
                d.rows > 0 && (m.difference.rows == 0 || d.largest < m.difference.largest))
                m.difference = d, m.sign = sign;
}

std::vector<ColumnMatch> matches(const std::string& file, const std::vector<SelectedExperiment>& all)
{
    const CsvTable table = read_csv_table(file);
    const std::vector<double> t = table.values("t");
    std::vector<ColumnMatch> found;
    for (const std::string& name : table.columns) {
        if (name == "t") continue;
        const std::vector<double> reference = table.values(name);
        const size_t first = found.size();
        for (const SelectedExperiment& c : all)
            for (size_t r = 0; r < c.runs.size(); ++r) {
                const Series& s = c.series[r];
                const size_t column = s.column_index(quantity_of(name, c.runs[r].name));
                if (s.rows() == 0 || column == s.columns.size()) continue;
                ColumnMatch m{.column = name,
                              .experiment = c.experiment->name,
                              .run = c.runs[r].name,
                              .difference = {}};
                find_best_shift(m, t, reference, s, column);
                if (m.difference.rows > 0) found.push_back(m);
            }
        const auto nearest = std::min_element(found.begin() + first, found.end(),
                                              [](const ColumnMatch& a, const ColumnMatch& b) {
                                                  return a.difference.largest < b.difference.largest;
                                              });
        if (nearest != found.end()) nearest->nearest = true;
    }
    if (found.empty())
        throw lie::InvalidInput(file + ": no column is a quantity of the selected experiments");
    return found;
}

/// Maximum over the columns of the difference to the nearest run, relative to the largest value of the column
double largest_difference(const std::vector<ColumnMatch>& found)
{
    double largest = 0;
    for (const ColumnMatch& m : found)
        if (m.nearest) largest = std::max(largest, m.difference.relative());
    return largest;
}

Table as_table(const std::vector<ColumnMatch>& found)
{
    Table out({{"column"},
               {"experiment"},
               {"run"},
               {"nearest"},
               {"largest difference"},
               {"at t [s]", "{:.4f}"},
               {"of size", "{:.4g}"},
               {"rows later", "{:.0f}"},
               {"sign", "{:+.0f}"}});
    for (const ColumnMatch& m : found)
        out.add({m.column, m.experiment, m.run, m.nearest ? "*" : "", m.difference.largest, m.difference.t,
                 m.difference.size, static_cast<double>(m.difference.shift), m.sign});
    return out;
}

std::string figure_of(const Experiment& e) { return e.figure.empty() ? "" : " (Fig. " + e.figure + ")"; }

int study(const StudyOptions& options)
{
    const std::vector<std::string> keys = {"difference"};
    check_keys(kind, options, keys);
    if (!options.expect.empty() && options.against.empty())
        throw io::UsageError("study friction: --expect difference needs --against FILE");
    refuse_schemes(kind, options);
    if (!options.steps.empty() || options.end)
        throw io::UsageError(
            "study friction: --steps and --end are not accepted, each experiment sets its own");
    std::vector<SelectedExperiment> all = selected(options);
    check_vtk(options, all);
    struct Job {
        SelectedExperiment* c;
        size_t run;
    };
    std::vector<Job> jobs;
    for (SelectedExperiment& c : all)
        for (size_t r = 0; r < c.runs.size(); ++r) jobs.push_back({&c, r});
    const bool remove_old_frames = options.force && !options.output.empty();
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(jobs.size())).run([&](long k) {
        const Job& job = jobs[k];
        const ExperimentRun& run = job.c->runs[job.run];
        const std::string name = job.c->experiment->name + '-' + run.name;
        if (remove_old_frames) Snapshots::remove(options.output, name);
        Frames frames{.count = options.vtk};
        const bool with_frames = options.vtk > 0 && job.c->experiment->has_frames;
        try {
            job.c->series[job.run] = run.compute(with_frames ? &frames : nullptr);
        } catch (const lie::NumericalFailure& e) {
            job.c->failures[job.run] = e.what();
        }
        if (with_frames) frames.snapshots.write(options.output, name);
    });

    StudyOutput output{.kind = kind};
    Table table({{"experiment"},
                 {"figure"},
                 {"what"},
                 {"measured", "{:.8g}"},
                 {"required", "{:.8g}"},
                 {"tolerance", "{:.1e}"},
                 {"by"},
                 {"passed"}});
    io::Json rows = io::Json::array();
    size_t criteria = 0, failed = 0;
    for (SelectedExperiment& c : all) {
        if (c.experiment->checks != nullptr) c.experiment->checks(Results(c.runs, c.series), c.checks);
        Table printed(
            {{"measured", "{:.8g}"}, {"required", "{:.8g}"}, {"+-", "{:.1e}"}, {"passed"}, {"by"}, {"what"}});
        for (size_t r = 0; r < c.runs.size(); ++r)  // a run that failed is a criterion that failed
            if (!c.failures[r].empty())
                c.checks.push_back({.what = "run " + c.runs[r].name + " ends",
                                    .measured = std::nan(""),
                                    .source = "failed: " + c.failures[r]});
        criteria += c.checks.size();
        for (const Check& k : c.checks) {
            const std::string passed = k.passed() ? "yes" : "NO";
            if (!k.passed()) ++failed;
            table.add({c.experiment->name, c.experiment->figure, k.what, k.measured, k.required, k.tolerance,
                       k.source, passed});
            printed.add({k.measured, k.required, k.tolerance, passed, k.source, k.what});
            rows.push_back({{"experiment", c.experiment->name},
                            {"what", k.what},
                            {"measured", k.measured},
                            {"required", k.required},
                            {"tolerance", k.tolerance},
                            {"by", k.source},
                            {"passed", k.passed()}});
        }
        output.text << fmt::format("\n{}{}: {}\n", c.experiment->name, figure_of(*c.experiment),
                                   c.experiment->what);
        if (!c.checks.empty()) printed.print(output.text);
        output.files.emplace_back(c.experiment->name + ".csv", curves(c));
        output.figures.push_back(fmt::format("{}-{}.png", kind, c.experiment->name));
    }
    output.text << fmt::format("\n{} of {} criteria passed{}\n", criteria - failed, criteria,
                               options.check ? "" : "; --check adds the long runs and their criteria");
    std::vector<Measured> measurements;
    if (!options.against.empty()) {
        const std::vector<ColumnMatch> found = matches(options.against, all);
        const Table differences = as_table(found);
        measurements.push_back({.of = options.against, .value = {{"difference", largest_difference(found)}}});
        output.text << fmt::format(
            "\ncomparison with {}: each column with every run that has the quantity; * marks the nearest "
            "run\n",
            options.against);
        differences.print(output.text);
        output.text << fmt::format(
            "largest difference of the nearest runs, relative to the column size: {:.2e}\n",
            measurements.back().value.at("difference"));
        output.files.emplace_back("against.csv", differences.csv());
    }
    if (options.vtk > 0)
        for (const SelectedExperiment& c : all)
            if (c.experiment->has_frames)
                output.text << fmt::format("\nframes for ParaView: {}/{}-*.pvd", options.output,
                                           c.experiment->name);
    if (options.vtk > 0) output.text << '\n';
    output.table = table.csv();
    output.json = {{"criteria", criteria}, {"passed", criteria - failed}, {"checks", rows}};
    const int code = finish(options, output, {}, measurements);
    if (options.check && failed > 0) return io::exit_code::expectation_failed;
    return code;
}

const bool registered = register_study(Study{
    .kind = kind,
    .answers = "sliding, rolling and spinning friction: experiments and acceptance criteria (Figs. 4.6-4.12, "
               "4.15-4.18, Table 4.7)",
    .accepted = takes::against | takes::check | takes::vtk,
    .run = study});

}  // namespace

}  // namespace hilda::studies
