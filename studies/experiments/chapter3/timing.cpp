// SPDX-License-Identifier: GPL-3.0-or-later
/// CPU time per step (Fang 2022, Fig. 3.10).
///
/// For each problem, step size and scheme, the thread CPU time of the whole run is divided by the number of
/// steps. The table contains the median, minimum and maximum of the repeats. No observer is active and
/// nothing is written during the measurement. The ratio is relative to rA-full-1 on the same problem with the
/// same step; a ratio below 1 means faster.

#include "studies/framework/stopwatch.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

const std::string timed_baseline = "rA-full-1";

/// CPU time ratio reported in the dissertation: half-implicit over fully implicit scheme
void print_half_over_full(const Sweep<TimedRun>& runs, StudyText& out)
{
    Table table({{"problem"}, {"h [s]", "{:.1e}"}, {"rA-half-1 / rA-full-1", "{:.3f}"}});
    double sum = 0;
    long count = 0;
    for (const TimedRun& run : runs) {
        if (run.scheme->name != "rA-half-1" || std::isnan(run.ratio)) continue;
        table.add({run.c->problem.name, run.h, run.ratio});
        sum += run.ratio, ++count;
    }
    if (count == 0) return;
    out << "\nratio of the CPU times per step, half-implicit over fully implicit\n";
    table.print(out);
    out << fmt::format("mean {:.3f}\n", sum / static_cast<double>(count));
}

void timing(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-2, 1e-3, 1e-4});
    const Schemes schemes = s.fixed_step_schemes();
    const std::vector<Benchmark> all = s.benchmarks({"double_pendulum", "slider_crank", "four_link"}, steps);
    Sweep<TimedRun> runs;
    for (const Benchmark& c : all)  // runs that are compared are timed directly after each other
        for (const double h : steps)
            for (const lie::Scheme* scheme : schemes) runs.add(c, *scheme, h);
    runs.compute(
        s, [&](TimedRun& run) { march(run, s.settings); }, ", first runs");
    time_in_turn(s, runs);
    set_ratios(runs, timed_baseline);

    const Columns<TimedRun> columns =
        Columns<TimedRun>{column::problem,         column::integrator, column::h,
                          column::steps,           column::iterations, column::factorizations,
                          column::refactorizations} +
        columns_of_times(timed_baseline) + Columns<TimedRun>{column::cpu_seconds_of_repeats, column::status};
    for (const Benchmark& c : all) {
        s.text << fmt::format("\n{}, end time {:g} s: thread CPU time per step\n", c.problem.name, c.end);
        columns.print(s.text, runs.of(c),
                      {"h", "integrator", "us_per_step", "us_per_step_min", "us_per_step_max",
                       "iterations_per_step", "ratio_to_full", "status"});
    }
    print_half_over_full(runs, s.text);
    s.text << fmt::format("\nmedian, min and max of {} repeats; parallel runs: {}\n", s.repeats,
                          s.jobs_at_once);
    s.json["runs"] = columns.array(
        runs, {"us_per_step", "us_per_step_min", "us_per_step_max", "ratio_to_full", "iterations_per_step"});
    s.figures = {"timing.png"};
    s.results(columns, runs);
    for (size_t k = 0; k < runs.size(); ++k)
        if (runs[k].scheme->name == timed_baseline) s.measured[k].value.erase("ratio_to_full");
    if (s.check) s.evaluate(criteria_of_times(runs));
}

const bool registered_timing =
    io::Registry<Study>::add({.name = "timing",
                              .answers = "CPU time per step by problem, scheme and step size (Fig. 3.10)",
                              .options = options_of_models({"--repeats", "--check", "--strict"}),
                              .keys = {"us_per_step", "ratio_to_full"},
                              .files = {"timing.png"},
                              .run = timing});

}  // namespace

}  // namespace hilda::studies
