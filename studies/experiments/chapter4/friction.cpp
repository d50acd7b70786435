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

#include "studies/experiments/chapter4/friction/experiment.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/csv_table.hpp"
#include "studies/framework/study_context.hpp"

#include "io/csv.hpp"
#include "io/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using namespace friction;

constexpr size_t max_rows = 2000;  // limit on the rows per run in NAME.csv

/// A selected experiment with its runs and their results
struct SelectedExperiment {
    const Experiment* experiment = nullptr;
    std::vector<ExperimentRun> runs = {};
    std::vector<Series> series = {};
    std::vector<std::string> failures = {};
};

std::vector<SelectedExperiment> selected(const StudyContext& s)
{
    std::vector<SelectedExperiment> all;
    for (const Experiment* e : selected_parts(s, "experiment", experiments())) {
        SelectedExperiment& c = all.emplace_back(SelectedExperiment{.experiment = e, .runs = e->runs()});
        std::erase_if(c.runs, [&](const ExperimentRun& run) { return run.check_only && !s.options.check; });
        c.series.resize(c.runs.size());
        c.failures.resize(c.runs.size());
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

/// The curves of all runs. The runs of an experiment may record different columns; the header is that of the first.
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

const Columns<ColumnMatch> columns_of_matches = {
    {"column", "column", &ColumnMatch::column},
    {"experiment", "experiment", &ColumnMatch::experiment},
    {"run", "run", &ColumnMatch::run},
    {"nearest", "nearest", [](const ColumnMatch& m) { return m.nearest ? "*" : ""; }},
    {"largest difference", "largest difference", [](const ColumnMatch& m) { return m.difference.largest; }},
    {"at t [s]", "at t [s]", "{:.4f}", [](const ColumnMatch& m) { return m.difference.t; }},
    {"of size", "of size", "{:.4g}", [](const ColumnMatch& m) { return m.difference.size; }},
    {"rows later", "rows later", "{:.0f}", [](const ColumnMatch& m) { return m.difference.shift; }},
    {"sign", "sign", "{:+.0f}", &ColumnMatch::sign}};

/// A criterion of an experiment
struct CheckedExperiment : Check {
    const Experiment* experiment = nullptr;
};
const Columns<CheckedExperiment> columns_of_checks = {
    {"experiment", [](const CheckedExperiment& k) { return k.experiment->name; }},
    {"figure", [](const CheckedExperiment& k) { return k.experiment->figure; }},
    {"what", "what", &CheckedExperiment::what},
    {"measured", "measured", "{:.8g}", &CheckedExperiment::measured},
    {"required", "required", "{:.8g}", &CheckedExperiment::required},
    {"tolerance", "+-", "{:.1e}", &CheckedExperiment::tolerance},
    {"by", "by", &CheckedExperiment::source},
    {"passed", "passed", [](const CheckedExperiment& k) { return k.passed() ? "yes" : "NO"; }}};

/// Evaluates the criteria of an experiment. A run that failed is a criterion that failed.
std::vector<CheckedExperiment> checks_of(const SelectedExperiment& c)
{
    std::vector<Check> checks;
    if (c.experiment->checks != nullptr) c.experiment->checks(Results(c.runs, c.series), checks);
    for (size_t r = 0; r < c.runs.size(); ++r)
        if (!c.failures[r].empty())
            checks.push_back({.what = "run " + c.runs[r].name + " ends",
                              .measured = std::nan(""),
                              .source = "failed: " + c.failures[r]});
    std::vector<CheckedExperiment> all;
    for (const Check& check : checks) all.push_back({check, c.experiment});
    return all;
}

/// Computes one run of an experiment and writes its frames.
void compute(SelectedExperiment& c, size_t r, const StudyOptions& options)
{
    const ExperimentRun& run = c.runs[r];
    const std::string name = c.experiment->name + '-' + run.name;
    if (options.force && !options.output.empty()) Snapshots::remove(options.output, name);
    Frames frames{.count = options.vtk};
    const bool with_frames = options.vtk > 0 && c.experiment->has_frames;
    try {
        c.series[r] = run.compute(with_frames ? &frames : nullptr);
    } catch (const io::NumericalFailure& e) {
        c.failures[r] = e.what();
    }
    if (with_frames) frames.snapshots.write(options.output, name);
}

void compare_with_file(StudyContext& s, const std::vector<SelectedExperiment>& all)
{
    const std::vector<ColumnMatch> found = matches(s.options.against, all);
    s.measured.push_back({.of = s.options.against, .value = {{"difference", largest_difference(found)}}});
    s.text << fmt::format(
        "\ncomparison with {}: each column with every run that has the quantity; * marks the nearest "
        "run\n",
        s.options.against);
    columns_of_matches.print(s.text, found);
    s.text << fmt::format("largest difference of the nearest runs, relative to the column size: {:.2e}\n",
                          s.measured.back().value.at("difference"));
    s.files.emplace_back("against.csv", columns_of_matches.csv(found));
}

void friction_experiments(StudyContext& s)
{
    const StudyOptions& options = s.options;
    if (!options.expect.empty() && options.against.empty())
        s.refuse("--expect difference needs --against FILE");
    s.refuse_models(true);
    if (!options.steps.empty() || options.end)
        s.refuse("--steps and --end are not accepted, each experiment sets its own");
    std::vector<SelectedExperiment> all = selected(s);
    std::vector<std::pair<SelectedExperiment*, size_t>> jobs;
    for (SelectedExperiment& c : all)
        for (size_t r = 0; r < c.runs.size(); ++r) jobs.emplace_back(&c, r);
    s.pool(jobs.size()).run([&](long k) { compute(*jobs[k].first, jobs[k].second, options); });

    std::vector<CheckedExperiment> checks;
    io::Json rows = io::Json::array();
    for (const SelectedExperiment& c : all) {
        const Experiment& e = *c.experiment;
        s.text << fmt::format("\n{}{}: {}\n", e.name, e.figure.empty() ? "" : " (Fig. " + e.figure + ")",
                              e.what);
        const std::vector<CheckedExperiment> of_this = checks_of(c);
        if (!of_this.empty())
            columns_of_checks.print(s.text, of_this,
                                    {"measured", "required", "tolerance", "passed", "by", "what"});
        for (const CheckedExperiment& k : of_this) {
            io::Json row =
                columns_of_checks.json(k, {"experiment", "what", "measured", "required", "tolerance", "by"});
            row["passed"] = k.passed();
            rows.push_back(row);
            checks.push_back(k);
        }
        s.files.emplace_back(e.name + ".csv", curves(c));
        s.figures.push_back(fmt::format("{}-{}.png", s.name, e.name));
    }
    const auto passed = static_cast<size_t>(
        std::count_if(checks.begin(), checks.end(), [](const Check& k) { return k.passed(); }));
    s.criteria_passed = passed == checks.size();
    s.text << fmt::format("\n{} of {} criteria passed{}\n", passed, checks.size(),
                          options.check ? "" : "; --check adds the long runs and their criteria");
    if (!options.against.empty()) compare_with_file(s, all);
    if (options.vtk > 0) {
        for (const SelectedExperiment& c : all)
            if (c.experiment->has_frames)
                s.text << fmt::format("\nframes for ParaView: {}/{}-*.pvd", options.output,
                                      c.experiment->name);
        s.text << '\n';
    }
    s.table = columns_of_checks.csv(checks);
    s.json = {{"criteria", checks.size()}, {"passed", passed}, {"checks", rows}};
}

const bool registered = io::Registry<Study>::add(
    {.name = "friction",
     .answers =
         "sliding, rolling and spinning friction: experiments and acceptance criteria (Figs. 4.6-4.12, "
         "4.15-4.18, Table 4.7)",
     .accepted = takes::against | takes::check | takes::vtk,
     .keys = {"difference"},
     .run = friction_experiments});

}  // namespace

}  // namespace hilda::studies
