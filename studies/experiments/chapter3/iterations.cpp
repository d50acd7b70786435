// SPDX-License-Identifier: GPL-3.0-or-later
/// Newton iterations of a step (Fang 2022, Figs. 3.9, 3.11, 3.12, 3.13).
///
/// For each problem, scheme and step: the mean and the most iterations of a step, all schemes at the same
/// Newton tolerance in the same lengths; iterations.csv has mean and most over short stretches of time. A
/// scheme that solves without iterating counts none.

#include "studies/csv.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using nlohmann::ordered_json;

const std::string kind = "iterations";
constexpr long most_bins = 300;  // of one run in iterations.csv

/// Iterations of the steps of a stretch of time
struct Bin {
    double end = 0;  ///< [s]
    long steps = 0, sum = 0;
    int most = 0;
};

class IterationsOfSteps final : public lie::Observer {
public:
    explicit IterationsOfSteps(long steps) : in_a_bin((steps + most_bins - 1) / most_bins) {}

    void accepted(const lie::State& x, long n, int iterations) override
    {
        if (n == 0) return;  // no step leads to the start
        if (bins.empty() || bins.back().steps == in_a_bin) bins.emplace_back();
        Bin& bin = bins.back();
        bin.end = x.t;
        ++bin.steps;
        bin.sum += iterations;
        bin.most = std::max(bin.most, iterations);
        most = std::max(most, iterations);
    }

    std::vector<Bin> bins;
    int most = 0;

private:
    const long in_a_bin;
};

struct IterationsRun : Run {
    std::vector<Bin> bins;
    int most = 0;

    double mean() const { return failed() ? std::nan("") : statistics.iterations_per_step(); }
};

void compute(IterationsRun& run, const StudyOptions& options)
{
    IterationsOfSteps steps(lie::TimeGrid::over(run.c->end, run.h).steps);
    lie::Observer* observers[] = {&steps};
    march(run, options.settings, observers);
    run.bins = std::move(steps.bins);
    run.most = steps.most;
}

Table as_table(const std::vector<IterationsRun>& runs)
{
    Table table({{"problem"},
                 {"integrator"},
                 {"h"},
                 {"steps"},
                 {"iterations_per_step"},
                 {"max_iterations"},
                 {"factorizations"},
                 {"refactorizations"},
                 {"status"}});
    for (const IterationsRun& run : runs)
        table.add({run.c->problem.name, run.scheme->name, run.h, static_cast<double>(run.statistics.steps),
                   run.mean(), static_cast<double>(run.most),
                   static_cast<double>(run.statistics.factorizations),
                   static_cast<double>(run.statistics.refactorizations), run.status});
    return table;
}

/// A line for each scheme, mean and most for each step
void print(const std::vector<IterationsRun>& runs, const Benchmark& c, const Schemes& schemes,
           const std::vector<double>& steps, std::ostream& out)
{
    std::vector<Table::Column> columns = {{"integrator"}};
    std::vector<std::string> heads;
    for (const double h : steps) heads.push_back(fmt::format("h = {:.0e} s", h));
    for (const std::string& head : heads)
        columns.insert(columns.end(), {{head, "{:.2f}"}, {"most", "{:.0f}"}});
    Table table(columns);
    for (const lie::Scheme* s : schemes) {
        std::vector<Table::Cell> row = {s->name};
        for (const IterationsRun& run : runs) {
            if (run.c != &c || run.scheme != s) continue;
            row.emplace_back(run.failed() ? Table::Cell(run.status) : Table::Cell(run.mean()));
            row.emplace_back(static_cast<double>(run.most));
        }
        table.add(row);
    }
    out << fmt::format("\n{}, over {:g} s: Newton iterations of a step, mean and most\n", c.problem.name,
                       c.end);
    table.print(out);
}

std::string over_time(const std::vector<IterationsRun>& runs)
{
    std::string csv = "problem,integrator,h,t,mean,max\n";
    for (const IterationsRun& run : runs) {
        for (const Bin& bin : run.bins) {
            csv += csv_field(run.c->problem.name) + ',' + csv_field(run.scheme->name);
            for (const double value :
                 {run.h, bin.end, static_cast<double>(bin.sum) / static_cast<double>(bin.steps),
                  static_cast<double>(bin.most)}) {
                csv += ',';
                append_number(csv, value);
            }
            csv += '\n';
        }
    }
    return csv;
}

ordered_json as_json(const std::vector<IterationsRun>& runs)
{
    ordered_json rows = ordered_json::array();
    for (const IterationsRun& run : runs) {
        ordered_json row = as_json(static_cast<const Run&>(run));
        row.update({{"steps", run.statistics.steps},
                    {"iterations_per_step", number_or_null(run.mean())},
                    {"max_iterations", run.most},
                    {"factorizations", run.statistics.factorizations}});
        rows.push_back(row);
    }
    return rows;
}

int iterations(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"iterations", "max_iterations"});
    const std::vector<double> steps = steps_or(options, {1e-2, 1e-3, 1e-4});
    const Schemes schemes = fixed_step_schemes(kind, options);
    const std::vector<Benchmark> all =
        benchmarks(kind, options, {"double_pendulum", "slider_crank", "four_link"});
    std::vector<IterationsRun> runs;
    for (const Benchmark& c : all) {
        check_steps(kind, c, steps);
        for (const lie::Scheme* s : schemes)
            for (const double h : steps) {
                IterationsRun run;
                run.c = &c, run.scheme = s, run.h = h;
                runs.push_back(run);
            }
    }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"runs", as_json(runs)}}};
    output.files = {{"iterations.csv", over_time(runs)}};
    for (const Benchmark& c : all) {
        print(runs, c, schemes, steps, output.text);
        output.figures.push_back("iterations-" + c.problem.name + ".png");
    }
    std::vector<Measured> came;
    for (const IterationsRun& run : runs)
        came.push_back(
            {.of = run.name(), .value = {{"iterations", run.mean()}, {"max_iterations", run.most}}});
    return finish(options, output, run_pointers(runs), came);
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "Newton iterations of a step, over step size and time (Figs. 3.9, 3.11-3.13)",
          .run = iterations});

}  // namespace

}  // namespace hilda::studies
