// SPDX-License-Identifier: GPL-3.0-or-later
/// CPU time per step (Fang 2022, Fig. 3.10).
///
/// For each problem, step size and scheme, the thread CPU time of the whole run is divided by the number of
/// steps. The table contains the median, minimum and maximum of the repeats. No observer is active and
/// nothing is written during the measurement. The ratio is relative to rA-full-1 on the same problem with the
/// same step; a ratio below 1 means faster.

#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/study_output.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

const std::string kind = "timing";
const std::string baseline = "rA-full-1";

struct StepTimeRun : TimedRun {
    double ratio = std::nan("");  ///< to rA-full-1
};

/// All runs, ordered by problem, step and scheme. Runs that are compared are timed directly after each other.
std::vector<StepTimeRun> runs_of(const std::vector<Benchmark>& all, const Schemes& schemes,
                                 const std::vector<double>& steps)
{
    std::vector<StepTimeRun> runs;
    for (const Benchmark& c : all)
        for (const double h : steps)
            for (const lie::Scheme* s : schemes) {
                StepTimeRun run;
                run.c = &c, run.scheme = s, run.h = h;
                runs.push_back(run);
            }
    return runs;
}

void set_ratios(std::vector<StepTimeRun>& runs)
{
    for (StepTimeRun& run : runs)
        for (const StepTimeRun& baseline_run : runs)
            if (baseline_run.c == run.c && baseline_run.h == run.h && baseline_run.scheme->name == baseline)
                run.ratio = studies::ratio(run, baseline_run);
}

Table as_table(const std::vector<StepTimeRun>& runs)
{
    Table table({{"problem"},
                 {"integrator"},
                 {"h"},
                 {"steps"},
                 {"iterations_per_step"},
                 {"factorizations"},
                 {"refactorizations"},
                 {"us_per_step"},
                 {"us_per_step_min"},
                 {"us_per_step_max"},
                 {"ratio_to_full"},
                 {"cpu_seconds"},
                 {"status"}});
    for (const StepTimeRun& run : runs)
        table.add({run.c->problem.name, run.scheme->name, run.h, static_cast<double>(run.statistics.steps),
                   run.statistics.iterations_per_step(), static_cast<double>(run.statistics.factorizations),
                   static_cast<double>(run.statistics.refactorizations), run.microseconds().median,
                   run.microseconds().least, run.microseconds().most, run.ratio,
                   run.seconds_of_repeats().median, run.status});
    return table;
}

void print(const std::vector<StepTimeRun>& runs, const Benchmark& c, std::ostream& out)
{
    Table table({{"h [s]", "{:.1e}"},
                 {"integrator"},
                 {"us/step", "{:.3f}"},
                 {"min", "{:.3f}"},
                 {"max", "{:.3f}"},
                 {"iter", "{:.2f}"},
                 {"time / " + baseline, "{:.3f}"},
                 {"status"}});
    for (const StepTimeRun& run : runs)
        if (run.c == &c)
            table.add({run.h, run.scheme->name, run.microseconds().median, run.microseconds().least,
                       run.microseconds().most, run.statistics.iterations_per_step(), run.ratio, run.status});
    out << fmt::format("\n{}, end time {:g} s: thread CPU time per step\n", c.problem.name, c.end);
    table.print(out);
}

/// CPU time ratio reported in the dissertation: half-implicit over fully implicit scheme
void print_half_over_full(const std::vector<StepTimeRun>& runs, std::ostream& out)
{
    Table table({{"problem"}, {"h [s]", "{:.1e}"}, {"rA-half-1 / rA-full-1", "{:.3f}"}});
    double sum = 0;
    long count = 0;
    for (const StepTimeRun& run : runs) {
        if (run.scheme->name != "rA-half-1" || std::isnan(run.ratio)) continue;
        table.add({run.c->problem.name, run.h, run.ratio});
        sum += run.ratio, ++count;
    }
    if (count == 0) return;
    out << "\nratio of the CPU times per step, half-implicit over fully implicit\n";
    table.print(out);
    out << fmt::format("mean {:.3f}\n", sum / static_cast<double>(count));
}

io::Json as_json(const std::vector<StepTimeRun>& runs)
{
    io::Json rows = io::Json::array();
    for (const StepTimeRun& run : runs) {
        io::Json row = as_json(static_cast<const Run&>(run));
        row.update({{"us_per_step", run.microseconds().median},
                    {"us_per_step_min", run.microseconds().least},
                    {"us_per_step_max", run.microseconds().most},
                    {"ratio_to_full", run.ratio},
                    {"iterations_per_step", run.statistics.iterations_per_step()}});
        rows.push_back(row);
    }
    return rows;
}

int timing(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"us_per_step", "ratio_to_full"});
    const std::vector<double> steps = steps_or(options, {1e-2, 1e-3, 1e-4});
    const Schemes schemes = fixed_step_schemes(kind, options);
    const std::vector<Benchmark> all =
        benchmarks(kind, options, {"double_pendulum", "slider_crank", "four_link"});
    for (const Benchmark& c : all) check_steps(kind, c, steps);

    std::vector<StepTimeRun> runs = runs_of(all, schemes, steps);
    const auto timed = pointers<TimedRun*>(runs);
    Pool(options.jobs, options.quiet ? "" : kind + ", first runs", static_cast<long>(runs.size()))
        .run([&](long k) { march(runs[k], options.settings); });
    time_in_turn(kind, options, timed, [&](long) { return options.settings; });
    set_ratios(runs);

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"runs", as_json(runs)}}};
    output.figures = {"timing.png"};
    for (const Benchmark& c : all) print(runs, c, output.text);
    print_half_over_full(runs, output.text);
    output.text << fmt::format("\nmedian, min and max of {} repeats; parallel runs: {}\n", options.repeats,
                               options.jobs);
    std::vector<Measured> measurements;
    for (const StepTimeRun& run : runs) {
        measurements.push_back({.of = run.name(), .value = {{"us_per_step", run.microseconds().median}}});
        if (run.scheme->name != baseline) measurements.back().value["ratio_to_full"] = run.ratio;
    }
    return finish(options, output, run_pointers(runs), measurements);
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "CPU time per step by problem, scheme and step size (Fig. 3.10)",
                         .accepted = takes::repeats,
                         .run = timing});

}  // namespace

}  // namespace hilda::studies
