// SPDX-License-Identifier: GPL-3.0-or-later
/// Work-precision diagrams: error against CPU time of each integrator.
///
/// Schemes with a fixed step run with each of --steps, schemes with step-size control with each of --rtols.
/// Each run has the errors of errors.hpp and the thread CPU time of the integration (median of the repeats,
/// without observers or output). A second table for each problem contains the CPU time that an integrator
/// needs for an rms error of 1e-3 m in r, interpolated between neighbouring runs on logarithmic axes.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/framework/work_needed.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

const std::string kind = "work-precision";
constexpr double target_error = 1e-3;  // rms error of r for which the CPU time is interpolated [m]

struct WorkRun : TimedRun {
    Errors errors;
};

void compute(WorkRun& run, const StudyOptions& options)
{
    EvaluatedRun evaluated;
    static_cast<Run&>(evaluated) = static_cast<const Run&>(run);
    evaluate(evaluated, options.settings);
    static_cast<Run&>(run) = static_cast<const Run&>(evaluated);
    run.errors = evaluated.errors;
}

/// End time [s]. Chains of more than two bars are chaotic: after one or two seconds the errors of all but the
/// smallest steps are as large as the motion, and the order is not visible. The end time of 1.2 s is a
/// multiple of steps such as 4e-3 s, so that all instants of the reference solution are nodes.
double end_of(const dae::Description& d)
{
    return d.name.starts_with("n_pendulum") && d.model->bodies() > 2 ? std::min(d.end, 1.2) : d.end;
}

/// Runs of one scheme on one problem, by decreasing step or tolerance
using WorkSeries = std::vector<const WorkRun*>;

std::vector<WorkSeries> series_of(const std::vector<WorkRun>& runs)
{
    std::vector<WorkSeries> all;
    for (const WorkRun& run : runs) {
        if (all.empty() || all.back().front()->c != run.c || all.back().front()->scheme != run.scheme)
            all.emplace_back();
        all.back().push_back(&run);
    }
    return all;
}

WorkNeeded work_to_target(const WorkSeries& series)
{
    std::vector<double> e, seconds;
    for (const WorkRun* run : series)
        e.push_back(run->errors.value[norm::r]), seconds.push_back(run->seconds_of_repeats().median);
    return work_needed(e, seconds, target_error);
}

Table as_table(const std::vector<WorkRun>& runs)
{
    std::vector<Table::Column> columns = {{"problem"}, {"integrator"}, {"h"},
                                          {"rtol"},    {"end"},        {"reference"}};
    for (const char* name : norm::names) columns.push_back({name});
    for (const char* name : {"steps", "iterations_per_step", "factorizations", "refactorizations",
                             "cpu_seconds", "cpu_seconds_min", "cpu_seconds_max", "status"})
        columns.push_back({name});
    Table table(columns);
    for (const WorkRun& run : runs) {
        const bool adaptive = run.rtol > 0;
        std::vector<Table::Cell> row = {run.c->problem.name,
                                        run.scheme->name,
                                        adaptive ? std::nan("") : run.h,
                                        adaptive ? run.rtol : std::nan(""),
                                        run.c->end,
                                        run.c->reference_name};
        for (const double e : run.errors.value) row.emplace_back(e);
        row.emplace_back(static_cast<double>(run.statistics.steps));
        row.emplace_back(run.statistics.iterations_per_step());
        row.emplace_back(static_cast<double>(run.statistics.factorizations));
        row.emplace_back(static_cast<double>(run.statistics.refactorizations));
        row.emplace_back(run.seconds_of_repeats().median);
        row.emplace_back(run.seconds_of_repeats().least);
        row.emplace_back(run.seconds_of_repeats().most);
        row.emplace_back(run.status);
        table.add(row);
    }
    return table;
}

void print(const std::vector<WorkRun>& runs, const Benchmark& c, std::ostream& out)
{
    Table table({{"integrator"},
                 {"step or rtol"},
                 {"r [m]"},
                 {"v [m/s]"},
                 {"Q"},
                 {"CPU [ms]", "{:.3f}"},
                 {"steps", "{:.0f}"},
                 {"iter", "{:.2f}"},
                 {"status"}});
    for (const WorkRun& run : runs)
        if (run.c == &c)
            table.add({run.scheme->name, run.resolution(), run.errors.value[norm::r],
                       run.errors.value[norm::v], run.errors.value[norm::Q],
                       1e3 * run.seconds_of_repeats().median, static_cast<double>(run.statistics.steps),
                       run.statistics.iterations_per_step(), run.status});
    out << fmt::format("\n{}, end time {:g} s; reference solution: {}\n", c.problem.name, c.end,
                       c.reference_name);
    table.print(out);
}

void print_work(const std::vector<WorkSeries>& all, const Benchmark& c, std::ostream& out)
{
    const WorkSeries* fastest = nullptr;
    for (const WorkSeries& series : all)
        if (series.front()->c == &c && !std::isnan(work_to_target(series).seconds) &&
            (fastest == nullptr || work_to_target(series).seconds < work_to_target(*fastest).seconds))
            fastest = &series;
    Table table({{"integrator"},
                 {fmt::format("CPU [ms] for error r = {:.0e} m", target_error)},
                 {"time / fastest", "{:.2f}"}});
    for (const WorkSeries& series : all) {
        if (series.front()->c != &c) continue;
        const WorkNeeded w = work_to_target(series);
        table.add(
            {series.front()->scheme->name,
             std::isnan(w.seconds) ? "-" : fmt::format("{}{:.3f}", w.at_most ? "<= " : "", 1e3 * w.seconds),
             fastest != nullptr ? w.seconds / work_to_target(*fastest).seconds : std::nan("")});
    }
    out << '\n';
    table.print(out);
    out << (fastest != nullptr
                ? fmt::format("fastest integrator for an rms error of {:.0e} m: {}\n", target_error,
                              fastest->front()->scheme->name)
                : fmt::format("no integrator reaches an rms error of {:.0e} m\n", target_error));
}

io::Json as_json(const std::vector<WorkSeries>& all)
{
    io::Json out = io::Json::array();
    for (const WorkSeries& series : all) {
        const WorkNeeded w = work_to_target(series);
        io::Json rows = io::Json::array();
        for (const WorkRun* run : series) {
            io::Json row = as_json(static_cast<const Run&>(*run));
            for (int n = 0; n < norm::count; ++n) row[norm::names[n]] = run->errors.value[n];
            row["steps"] = run->statistics.steps;
            row["iterations_per_step"] = run->statistics.iterations_per_step();
            row["factorizations"] = run->statistics.factorizations;
            row["cpu_seconds"] = run->seconds_of_repeats().median;
            rows.push_back(row);
        }
        out.push_back({{"problem", series.front()->c->problem.name},
                       {"integrator", series.front()->scheme->name},
                       {"reference", series.front()->c->reference_name},
                       {"asked_r", target_error},
                       {"cpu_seconds_needed", w.seconds},
                       {"at_most", w.at_most},
                       {"rows", rows}});
    }
    return out;
}

int work_precision(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"cpu_seconds_needed"});
    const Schemes schemes = any_schemes(options);
    const std::vector<double> steps = steps_or(options, {1e-2, 4e-3, 2e-3, 1e-3, 4e-4, 2e-4, 1e-4});
    const std::vector<double> rtols =
        options.rtols.empty() ? std::vector<double>{1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}
                              : options.rtols;
    Evaluated evaluated;
    for (const lie::Scheme* s : schemes)
        if (s->adaptive)
            evaluated.smallest_rtol = rtols.back();
        else
            evaluated.smallest_step = steps.back(),
            evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    std::vector<Benchmark> all =
        benchmarks(kind, options, {"double_pendulum", "n_pendulum_8", "n_pendulum_64"}, end_of);
    for (const Benchmark& c : all)
        if (evaluated.smallest_step > 0) check_steps(kind, c, steps, c.instants.dt * c.instants.stride);
    reference.evaluate(all);

    std::vector<WorkRun> runs;
    for (const Benchmark& c : all)
        for (const lie::Scheme* s : schemes)
            for (const double resolution : s->adaptive ? rtols : steps) {
                WorkRun run;
                run.c = &c, run.scheme = s;
                // Only the nodes that the rms norms need: an adaptive scheme may have to end a step at each
                // node.
                run.h = s->adaptive ? c.instants.dt * c.instants.stride : resolution;
                run.rtol = s->adaptive ? resolution : 0;
                runs.push_back(run);
            }
    Pool(options.jobs, options.quiet ? "" : kind + ", errors", static_cast<long>(runs.size()))
        .run([&](long k) { compute(runs[k], options); });
    const auto timed = pointers<TimedRun*>(runs);
    time_in_turn(kind, options, timed, [&](long) { return options.settings; });

    const std::vector<WorkSeries> series = series_of(runs);
    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"series", as_json(series)}}};
    for (const Benchmark& c : all) print(runs, c, output.text);
    for (const Benchmark& c : all) {
        output.text << '\n' << c.problem.name << ':';
        print_work(series, c, output.text);
        output.figures.push_back("work-precision-" + c.problem.name + ".png");
    }
    output.text << fmt::format(
        "\nCPU time of a run: median of {} repeats; parallel runs: {}. <=: the fastest run already "
        "reaches this accuracy\n",
        options.repeats, options.jobs);
    std::vector<Measured> measurements;
    for (const WorkSeries& s : series)
        measurements.push_back({.of = s.front()->scheme->name + " on " + s.front()->c->problem.name,
                                .value = {{"cpu_seconds_needed", work_to_target(s).seconds}}});
    return finish(options, output, run_pointers(runs), measurements);
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "error against CPU time of all integrators, including those with step-size control",
          .accepted = takes::reference | takes::rtols | takes::repeats,
          .run = work_precision});

}  // namespace

}  // namespace hilda::studies
