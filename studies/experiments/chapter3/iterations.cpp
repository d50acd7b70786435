// SPDX-License-Identifier: GPL-3.0-or-later
/// Newton iterations per step (Fang 2022, Figs. 3.9, 3.11, 3.12, 3.13).
///
/// For each problem, scheme and step size: mean and maximum number of Newton iterations per step. All schemes
/// have the same Newton tolerance, in the same units. iterations.csv contains mean and maximum over short
/// time intervals. Schemes without Newton iterations count zero.

#include "io/csv.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

const std::string kind = "iterations";
constexpr long max_bins = 300;  // limit on the rows per run in iterations.csv

/// Iterations of the steps in one time interval
struct IterationBin {
    double end = 0;  ///< [s]
    long steps = 0, sum = 0;
    int max_iterations = 0;
};

class IterationRecorder final : public lie::Observer {
public:
    explicit IterationRecorder(long steps) : steps_per_bin((steps + max_bins - 1) / max_bins) {}

    void accepted(const lie::State& x, long n, int iterations) override
    {
        if (n == 0) return;  // node 0 is the start; it is not the result of a step
        if (bins.empty() || bins.back().steps == steps_per_bin) bins.emplace_back();
        IterationBin& bin = bins.back();
        bin.end = x.t;
        ++bin.steps;
        bin.sum += iterations;
        bin.max_iterations = std::max(bin.max_iterations, iterations);
        max_iterations = std::max(max_iterations, iterations);
    }

    std::vector<IterationBin> bins;
    int max_iterations = 0;

private:
    const long steps_per_bin;
};

struct IterationsRun : Run {
    std::vector<IterationBin> bins;
    int max_iterations = 0;

    double mean() const { return failed() ? std::nan("") : statistics.iterations_per_step(); }
};

void compute(IterationsRun& run, const StudyOptions& options)
{
    IterationRecorder recorder(lie::TimeGrid::over(run.c->end, run.h).steps);
    lie::Observer* observers[] = {&recorder};
    march(run, options.settings, observers);
    run.bins = std::move(recorder.bins);
    run.max_iterations = recorder.max_iterations;
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
                   run.mean(), static_cast<double>(run.max_iterations),
                   static_cast<double>(run.statistics.factorizations),
                   static_cast<double>(run.statistics.refactorizations), run.status});
    return table;
}

/// One row for each scheme; mean and maximum for each step size
void print(const std::vector<IterationsRun>& runs, const Benchmark& c, const Schemes& schemes,
           const std::vector<double>& steps, std::ostream& out)
{
    std::vector<Table::Column> columns = {{"integrator"}};
    std::vector<std::string> headings;
    for (const double h : steps) headings.push_back(fmt::format("h = {:.0e} s", h));
    for (const std::string& heading : headings)
        columns.insert(columns.end(), {{heading, "{:.2f}"}, {"max", "{:.0f}"}});
    Table table(columns);
    for (const lie::Scheme* s : schemes) {
        std::vector<Table::Cell> row = {s->name};
        for (const IterationsRun& run : runs) {
            if (run.c != &c || run.scheme != s) continue;
            row.emplace_back(run.failed() ? Table::Cell(run.status) : Table::Cell(run.mean()));
            row.emplace_back(static_cast<double>(run.max_iterations));
        }
        table.add(row);
    }
    out << fmt::format("\n{}, end time {:g} s: Newton iterations per step, mean and maximum\n",
                       c.problem.name, c.end);
    table.print(out);
}

std::string over_time(const std::vector<IterationsRun>& runs)
{
    std::string csv = "problem,integrator,h,t,mean,max\n";
    for (const IterationsRun& run : runs) {
        for (const IterationBin& bin : run.bins) {
            csv += io::csv_field(run.c->problem.name) + ',' + io::csv_field(run.scheme->name);
            for (const double value :
                 {run.h, bin.end, static_cast<double>(bin.sum) / static_cast<double>(bin.steps),
                  static_cast<double>(bin.max_iterations)}) {
                csv += ',';
                io::append_number(csv, value);
            }
            csv += '\n';
        }
    }
    return csv;
}

io::Json as_json(const std::vector<IterationsRun>& runs)
{
    io::Json rows = io::Json::array();
    for (const IterationsRun& run : runs) {
        io::Json row = as_json(static_cast<const Run&>(run));
        row.update({{"steps", run.statistics.steps},
                    {"iterations_per_step", run.mean()},
                    {"max_iterations", run.max_iterations},
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
    std::vector<Measured> measurements;
    for (const IterationsRun& run : runs)
        measurements.push_back(
            {.of = run.name(),
             .value = {{"iterations", run.mean()}, {"max_iterations", run.max_iterations}}});
    return finish(options, output, run_pointers(runs), measurements);
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "Newton iterations per step over step size and time (Figs. 3.9, 3.11-3.13)",
          .run = iterations});

}  // namespace

}  // namespace hilda::studies
