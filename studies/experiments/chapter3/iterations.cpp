// SPDX-License-Identifier: GPL-3.0-or-later
/// Newton iterations per step (Fang 2022, Figs. 3.9, 3.11, 3.12, 3.13).
///
/// For each problem, scheme and step size: mean and maximum number of Newton iterations per step. All schemes
/// have the same Newton tolerance, in the same units. iterations.csv contains mean and maximum over short
/// time intervals. Schemes without Newton iterations count zero.

#include "studies/framework/acceptance.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

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

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.list(bins), a.value(max_iterations);
    }
    double mean() const { return failed() ? std::nan("") : statistics.iterations_per_step(); }
};

void compute(IterationsRun& run, const lie::Settings& settings)
{
    IterationRecorder recorder(lie::TimeGrid::over(run.c->end, run.h).steps);
    lie::Observer* observers[] = {&recorder};
    march(run, settings, observers);
    run.bins = std::move(recorder.bins);
    run.max_iterations = recorder.max_iterations;
}

/// One row for each scheme; mean and maximum for each step size
void print(const Sweep<IterationsRun>& runs, const Benchmark& c, const Schemes& schemes,
           const std::vector<double>& steps, StudyText& out)
{
    std::vector<Table::Column> columns = {{"integrator"}};
    for (const double h : steps)
        columns.insert(columns.end(), {{fmt::format("h = {:.0e} s", h), "{:.2f}"}, {"max", "{:.0f}"}});
    Table table(columns);
    for (const lie::Scheme* s : schemes) {
        std::vector<Table::Cell> row = {s->name};
        for (const IterationsRun* run : runs.of(c)) {
            if (run->scheme != s) continue;
            row.push_back(run->failed() ? Table::Cell(run->status) : Table::Cell(run->mean()));
            row.emplace_back(run->max_iterations);
        }
        table.add(row);
    }
    out << fmt::format("\n{}, end time {:g} s: Newton iterations per step, mean and maximum\n",
                       c.problem.name, c.end);
    table.print(out);
}

std::string over_time(const std::vector<IterationsRun>& runs)
{
    Table table({{"problem"}, {"integrator"}, {"h"}, {"t"}, {"mean"}, {"max"}});
    for (const IterationsRun& run : runs)
        for (const IterationBin& bin : run.bins)
            table.add({run.c->problem.name, run.scheme->name, run.h, bin.end,
                       static_cast<double>(bin.sum) / static_cast<double>(bin.steps), bin.max_iterations});
    return table.csv();
}

/// Figs. 3.9, 3.11-3.13: the half-implicit scheme needs fewer iterations than the fully implicit one with
/// large steps, and the second-order scheme as many as that of first order.
std::vector<Criterion> criteria_of_iterations(const std::vector<IterationsRun>& runs)
{
    std::vector<Criterion> all;
    const auto ratio = [&](const char* scheme, const char* to, double h, double least, double most) {
        for (const IterationsRun& run : runs)
            for (const IterationsRun& other : runs)
                if (run.scheme->name == scheme && other.scheme->name == to && run.c == other.c &&
                    run.h == other.h && run.h >= h)
                    all.push_back(
                        between("iterations over those of " + other.scheme->name + ", " + run.name(),
                                run.mean() / other.mean(), least, most));
    };
    ratio("rA-half-1", "rA-full-1", 1e-2, 0.7, 1);
    ratio("rA-half-2", "rA-half-1", 0, 0.95, 1.05);
    return all;
}

void iterations(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-2, 1e-3, 1e-4});
    const Schemes schemes = s.fixed_step_schemes();
    const std::vector<Benchmark> all = s.benchmarks({"double_pendulum", "slider_crank", "four_link"}, steps);
    Sweep<IterationsRun> runs(all, schemes, steps);
    runs.compute(s, [&](IterationsRun& run) { compute(run, s.settings); });

    const Columns<IterationsRun> columns = {column::problem,
                                            column::integrator,
                                            column::h,
                                            column::steps,
                                            {"iterations_per_step", &IterationsRun::mean},
                                            {"max_iterations", &IterationsRun::max_iterations},
                                            column::factorizations,
                                            column::refactorizations,
                                            column::status};
    for (const Benchmark& c : all) {
        print(runs, c, schemes, steps, s.text);
        s.figures.push_back("iterations-" + c.problem.name + ".png");
    }
    s.json["runs"] =
        columns.array(runs, {"steps", "iterations_per_step", "max_iterations", "factorizations"});
    s.files = {{"iterations.csv", over_time(runs)}};
    s.results(columns, runs);
    for (size_t k = 0; k < runs.size(); ++k) s.measured[k].value["iterations"] = runs[k].mean();
    if (s.check) s.evaluate(criteria_of_iterations(runs));
}

const bool registered_iterations = io::Registry<Study>::add(
    {.name = "iterations",
     .answers = "Newton iterations per step over step size and time (Figs. 3.9, 3.11-3.13)",
     .options = options_of_models({"--check", "--strict", "--shard"}),
     .keys = {"iterations", "max_iterations"},
     .files = {"iterations.csv", "iterations-PROBLEM.png"},
     .run = iterations});

}  // namespace

}  // namespace hilda::studies
