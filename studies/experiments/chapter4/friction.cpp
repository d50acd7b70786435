// SPDX-License-Identifier: GPL-3.0-or-later
/// The experiments on friction (Fang 2022, Sec. 4.4) and what must come out of them.
///
/// Each experiment is a few runs, from the smallest bodies in contact that show the matter. The table sets the number
/// that came out beside the demanded one; NAME.csv has the curves of experiment NAME, thinned. --against FILE compares every
/// step of the runs with the columns of a table: a column "x_damped" with column x of run damped, a column "x" with column
/// x of every run, of which the one that comes nearest is marked. --check does the runs that only the table needs too,
/// and exits with 6 where a demand is not met.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "studies/csv.hpp"
#include "studies/exit_codes.hpp"
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
using nlohmann::ordered_json;

const std::string kind = "friction";
constexpr size_t most_rows = 2000;  // of one run in a CSV

/// An experiment that was chosen, and its runs
struct Selection {
    const Experiment* experiment = nullptr;
    std::vector<ExperimentRun> runs;
    std::vector<Series> series;
    std::vector<std::string> failures;
    std::vector<Check> checks;
};

std::vector<Selection> selected(const StudyOptions& options)
{
    std::vector<std::string> known;
    for (const Experiment& e : experiments()) known.push_back(e.name);
    for (const std::string& name : options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw UsageError("study friction: unknown experiment" + with_nearest(name, known));
    std::vector<Selection> all;
    for (const Experiment& e : experiments()) {
        const auto& wanted = options.problems;
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), e.name) == wanted.end()) continue;
        Selection c;
        c.experiment = &e, c.runs = e.runs();
        std::erase_if(c.runs, [&](const ExperimentRun& run) { return run.for_check && !options.check; });
        c.series.resize(c.runs.size());
        c.failures.resize(c.runs.size());
        all.push_back(std::move(c));
    }
    return all;
}

/// Where nothing would come of --vtk
void check_vtk(const StudyOptions& options, const std::vector<Selection>& all)
{
    if (options.vtk == 0) return;
    studies::check_vtk(kind, options);
    if (std::any_of(all.begin(), all.end(), [](const Selection& c) { return c.experiment->in_space; }))
        return;
    std::string those;
    for (const Experiment& e : experiments())
        if (e.in_space) those += (those.empty() ? "" : ", ") + e.name;
    throw UsageError("study friction: --vtk is for " + those);
}

std::string curves(const Selection& c)
{
    std::string csv = "run";
    for (const Series& s : c.series)
        if (s.rows() > 0) {
            for (const std::string& column : s.columns) csv += ',' + csv_field(column);
            break;
        }
    csv += '\n';
    for (size_t r = 0; r < c.runs.size(); ++r) {
        const Series& s = c.series[r];
        const size_t every = std::max<size_t>(1, (s.rows() + most_rows - 1) / most_rows);
        for (size_t k = 0; k < s.rows(); k += every) {
            csv += csv_field(c.runs[r].name);
            for (size_t column = 0; column < s.columns.size(); ++column) {
                csv += ',';
                append_number(csv, s.at(k, column));
            }
            csv += '\n';
        }
    }
    return csv;
}

/// Largest difference of two columns, and where
struct Difference {
    double largest = 0, t = 0, size = 0;
    long shift = 0, rows = 0;

    double relative() const { return size > 0 ? largest / size : largest; }
};

/// Rows with the same t, the file's against ours or against ours of `shift` rows before; signs may differ by convention
Difference difference(const std::vector<double>& t, const std::vector<double>& theirs, const Series& s,
                      size_t column, long shift, double sign)
{
    Difference d{.shift = shift};
    const double h = s.rows() > 1 ? s.at(1, 0) - s.at(0, 0) : 1;
    for (size_t k = 1; k < t.size(); ++k) {  // published runs leave rows of the start unset
        const long row = std::lround(t[k] / h) - shift;
        if (row < 0 || row >= static_cast<long>(s.rows()) || !std::isfinite(theirs[k])) continue;
        if (std::abs(static_cast<double>(row + shift) * h - t[k]) > 1e-6 * h) continue;
        ++d.rows;
        d.size = std::max(d.size, std::abs(theirs[k]));
        const double off = std::abs(theirs[k] - sign * s.at(static_cast<size_t>(row), column));
        if (off > d.largest) d.largest = off, d.t = t[k];
        if (std::isnan(off)) d.largest = INFINITY, d.t = t[k];
    }
    return d;
}

/// x of x_damped for run damped and of x_KE5e6 for run upright-KE5e6; else the whole name
std::string base_of(const std::string& column, const std::string& run)
{
    const size_t at = column.find('_');
    if (at == std::string::npos) return column;
    const std::string of = column.substr(at + 1);
    return run == of || run.ends_with('-' + of) ? column.substr(0, at) : column;
}

/// A column of the file with a run that has it too
struct Match {
    std::string column, experiment, run;
    Difference difference;
    double sign = 1;
    bool nearest = false;  ///< of all runs that have this column
};

/// The same curve may be a row late, or have the other sign.
void match(Match& m, const std::vector<double>& t, const std::vector<double>& theirs, const Series& s,
           size_t column)
{
    for (const long shift : {0L, 1L})
        for (const double sign : {1., -1.})
            if (const Difference d = difference(t, theirs, s, column, shift, sign);
                d.rows > 0 && (m.difference.rows == 0 || d.largest < m.difference.largest))
                m.difference = d, m.sign = sign;
}

std::vector<Match> matches(const std::string& file, const std::vector<Selection>& all)
{
    const CsvTable table = read_csv_table(file);
    const std::vector<double> t = table.values("t");
    std::vector<Match> found;
    for (const std::string& name : table.columns) {
        if (name == "t") continue;
        const std::vector<double> theirs = table.values(name);
        const size_t first = found.size();
        for (const Selection& c : all)
            for (size_t r = 0; r < c.runs.size(); ++r) {
                const Series& s = c.series[r];
                const size_t column = s.place(base_of(name, c.runs[r].name));
                if (s.rows() == 0 || column == s.columns.size()) continue;
                Match m{.column = name,
                        .experiment = c.experiment->name,
                        .run = c.runs[r].name,
                        .difference = {}};
                match(m, t, theirs, s, column);
                if (m.difference.rows > 0) found.push_back(m);
            }
        const auto nearest = std::min_element(
            found.begin() + first, found.end(),
            [](const Match& a, const Match& b) { return a.difference.largest < b.difference.largest; });
        if (nearest != found.end()) nearest->nearest = true;
    }
    if (found.empty())
        throw lie::InvalidInput(file + ": no column of it is a column of the chosen experiments");
    return found;
}

/// Over the columns, of the run that comes nearest, by the size of the column
double largest_difference(const std::vector<Match>& found)
{
    double largest = 0;
    for (const Match& m : found)
        if (m.nearest) largest = std::max(largest, m.difference.relative());
    return largest;
}

Table as_table(const std::vector<Match>& found)
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
    for (const Match& m : found)
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
        throw UsageError("study friction: --expect difference needs --against FILE");
    refuse_schemes(kind, options);
    if (!options.steps.empty() || options.end)
        throw UsageError("study friction: --steps and --end are set by each experiment");
    std::vector<Selection> all = selected(options);
    check_vtk(options, all);
    struct Job {
        Selection* c;
        size_t run;
    };
    std::vector<Job> jobs;
    for (Selection& c : all)
        for (size_t r = 0; r < c.runs.size(); ++r) jobs.push_back({&c, r});
    const bool anew = options.force && !options.output.empty();
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(jobs.size())).run([&](long k) {
        const Job& job = jobs[k];
        const ExperimentRun& run = job.c->runs[job.run];
        const std::string name = job.c->experiment->name + '-' + run.name;
        if (anew) Snapshots::remove(options.output, name);
        Frames frames{.count = options.vtk};
        const bool seen = options.vtk > 0 && job.c->experiment->in_space;
        try {
            job.c->series[job.run] = run.go(seen ? &frames : nullptr);
        } catch (const lie::NumericalFailure& e) {
            job.c->failures[job.run] = e.what();
        }
        if (seen) frames.snapshots.write(options.output, name);
    });

    StudyOutput output{.kind = kind};
    Table table({{"experiment"},
                 {"figure"},
                 {"what"},
                 {"measured", "{:.8g}"},
                 {"demanded", "{:.8g}"},
                 {"tolerance", "{:.1e}"},
                 {"by"},
                 {"met"}});
    ordered_json rows = ordered_json::array();
    size_t criteria = 0, missed = 0;
    for (Selection& c : all) {
        if (c.experiment->checks != nullptr) c.experiment->checks(Results(c.runs, c.series), c.checks);
        Table shown(
            {{"measured", "{:.8g}"}, {"demanded", "{:.8g}"}, {"+-", "{:.1e}"}, {"met"}, {"by"}, {"what"}});
        for (size_t r = 0; r < c.runs.size(); ++r)  // a run that did not end is a demand that is not met
            if (!c.failures[r].empty())
                c.checks.push_back({.what = "run " + c.runs[r].name + " ends",
                                    .measured = std::nan(""),
                                    .by = "failed: " + c.failures[r]});
        criteria += c.checks.size();
        for (const Check& k : c.checks) {
            const std::string passed = k.passed() ? "yes" : "NO";
            if (!k.passed()) ++missed;
            table.add({c.experiment->name, c.experiment->figure, k.what, k.measured, k.required, k.tolerance,
                       k.by, passed});
            shown.add({k.measured, k.required, k.tolerance, passed, k.by, k.what});
            rows.push_back({{"experiment", c.experiment->name},
                            {"what", k.what},
                            {"measured", number_or_null(k.measured)},
                            {"demanded", k.required},
                            {"tolerance", k.tolerance},
                            {"by", k.by},
                            {"met", k.passed()}});
        }
        output.text << fmt::format("\n{}{}: {}\n", c.experiment->name, figure_of(*c.experiment),
                                   c.experiment->what);
        if (!c.checks.empty()) shown.print(output.text);
        output.files.emplace_back(c.experiment->name + ".csv", curves(c));
        output.figures.push_back(fmt::format("{}-{}.png", kind, c.experiment->name));
    }
    output.text << fmt::format("\n{} of {} demands met{}\n", criteria - missed, criteria,
                               options.check ? "" : "; --check does the long runs too, and judges by them");
    std::vector<Measured> came;
    if (!options.against.empty()) {
        const std::vector<Match> found = matches(options.against, all);
        const Table differences = as_table(found);
        came.push_back({.of = options.against, .value = {{"difference", largest_difference(found)}}});
        output.text << fmt::format(
            "\nagainst {}: each column with every run that has it, the nearest marked\n", options.against);
        differences.print(output.text);
        output.text << fmt::format("largest difference of the nearest, over the size of its column: {:.2e}\n",
                                   came.back().value.at("difference"));
        output.files.emplace_back("against.csv", differences.csv());
    }
    if (options.vtk > 0)
        for (const Selection& c : all)
            if (c.experiment->in_space)
                output.text << fmt::format("\nfor ParaView: {}/{}-*.pvd", options.output, c.experiment->name);
    if (options.vtk > 0) output.text << '\n';
    output.table = table.csv();
    output.json = {{"demands", criteria}, {"met", criteria - missed}, {"checks", rows}};
    const int code = finish(options, output, {}, came);
    if (options.check && missed > 0) return exit_code::expectation_failed;
    return code;
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "sliding, rolling and spinning friction (Figs. 4.6-4.12, 4.15-4.18, Table 4.7)",
          .also = takes::against | takes::check | takes::vtk,
          .run = study});

}  // namespace

}  // namespace hilda::studies
