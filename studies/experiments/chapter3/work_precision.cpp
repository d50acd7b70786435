// SPDX-License-Identifier: GPL-3.0-or-later
/// Work-precision diagrams: error against CPU time of each integrator.
///
/// Schemes with a fixed step run with each of --steps, schemes with step-size control with each of --rtols.
/// Each run has the errors of errors.hpp and the thread CPU time of the integration (median of the repeats,
/// without observers or output). A second table for each problem contains the CPU time that an integrator
/// needs for an rms error of 1e-3 m in r, interpolated between neighbouring runs on logarithmic axes.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "studies/experiments/chapter3/work_runs.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

constexpr double target_error = 1e-3;  // rms error of r for which the CPU time is interpolated [m]

/// End time [s]. Chains of more than two bars are chaotic: after one or two seconds the errors of all but the
/// smallest steps are as large as the motion, and the order is not visible. The end time of 1.2 s is a
/// multiple of steps such as 4e-3 s, so that all instants of the reference solution are nodes.
double end_of(const dae::Description& d)
{
    return d.name.starts_with("n_pendulum") && d.model->bodies() > 2 ? std::min(d.end, 1.2) : d.end;
}

WorkNeeded work_to_target(const WorkSeries& series) { return work_needed(series, target_error); }

void print_work(const std::vector<WorkSeries>& all, const Benchmark& c, StudyText& out)
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
        table.add({series.front()->scheme->name, milliseconds(w, 3),
                   fastest != nullptr ? w.seconds / work_to_target(*fastest).seconds : std::nan("")});
    }
    out << '\n';
    table.print(out);
    out << (fastest != nullptr
                ? fmt::format("fastest integrator for an rms error of {:.0e} m: {}\n", target_error,
                              fastest->front()->scheme->name)
                : fmt::format("no integrator reaches an rms error of {:.0e} m\n", target_error));
}

void work_precision(StudyContext& s)
{
    const WorkGrid grid(s, {}, {1e-2, 4e-3, 2e-3, 1e-3, 4e-4, 2e-4, 1e-4},
                        {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10});
    const Reference reference(s, grid.finest());
    std::vector<Benchmark> all =
        benchmarks(s.name, s.options, {"double_pendulum", "n_pendulum_8", "n_pendulum_64"}, end_of);
    const Sweep<WorkRun> runs = work_runs(s, grid, reference, all);

    const Columns<WorkRun> columns =
        Columns<WorkRun>{column::problem, column::integrator, column::resolution, column::h,
                         column::rtol,    column::end,        column::reference} +
        columns_of_work();
    const std::vector<WorkSeries> series = series_of(runs);
    for (const Benchmark& c : all) {
        s.text << fmt::format("\n{}, end time {:g} s; reference solution: {}\n", c.problem.name, c.end,
                              c.reference_name);
        columns.print(s.text, runs.of(c),
                      {"integrator", "step or rtol", "r", "v", "Q", "CPU [ms]", "steps",
                       "iterations_per_step", "status"});
    }
    for (const Benchmark& c : all) {
        s.text << '\n' << c.problem.name << ':';
        print_work(series, c, s.text);
        s.figures.push_back("work-precision-" + c.problem.name + ".png");
    }
    s.text << fmt::format(
        "\nCPU time of a run: median of {} repeats; parallel runs: {}. <=: the fastest run "
        "already reaches this accuracy\n",
        s.repeats, s.jobs_at_once);
    std::vector<std::string> in_json(norm::names.begin(), norm::names.end());
    in_json.insert(in_json.end(), {"steps", "iterations_per_step", "factorizations", "cpu_seconds"});
    for (const WorkSeries& of : series) {
        const WorkNeeded w = work_to_target(of);
        const WorkRun& first = *of.front();
        s.measured.push_back({.of = first.scheme->name + " on " + first.c->problem.name,
                              .value = {{"cpu_seconds_needed", w.seconds}}});
        s.json["series"].push_back({{"problem", first.c->problem.name},
                                    {"integrator", first.scheme->name},
                                    {"reference", first.c->reference_name},
                                    {"asked_r", target_error},
                                    {"cpu_seconds_needed", w.seconds},
                                    {"at_most", w.at_most},
                                    {"rows", columns.array(of, in_json)}});
    }
    s.table = columns.csv(runs);
    s.end_of_runs(run_pointers(runs));
}

const bool registered_work_precision = io::Registry<Study>::add(
    {.name = "work-precision",
     .answers = "error against CPU time of all integrators, including those with step-size control",
     .options = options_of_models({"--reference", "--rtols", "--atol", "--repeats", "--strict"}),
     .keys = {"cpu_seconds_needed"},
     .files = {"work-precision-PROBLEM.png"},
     .run = work_precision});

}  // namespace

}  // namespace hilda::studies
