// SPDX-License-Identifier: GPL-3.0-or-later
/// Study stiffness: error against CPU time of integrators for stiff loads.
///
/// The double pendulum of the problem double_pendulum_strut with the stiffness k = 1e3 … 1e10 N/m of its
/// strut without a damper, and with the damping c = 1e2 … 1e5 N s/m at k = 1e6 N/m. The natural frequency of
/// the strut's length is ω = sqrt(k/m) with m = 87 kg, the mass that the strut sees at the start. Integrators
/// with a fixed step run with each of --steps, those with step-size control with each of --rtols.
///
/// The tables have the CPU times for rms errors of r of 1e-4, 1e-6 and 1e-9 m, interpolated between
/// neighbouring runs on logarithmic axes. A run whose step is too large for an explicit scheme fails or has
/// errors of the size of the motion; neither counts.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/message.hpp"
#include "studies/experiments/chapter3/work_runs.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

/// rms errors of r for which the CPU time is interpolated [m]
constexpr double accuracy[] = {1e-4, 1e-6, 1e-9};

struct Strut {
    double k, c;  // [N/m], [N s/m]
    std::string name() const { return fmt::format("k = {:g}, c = {:g}", k, c); }
};

const std::vector<Strut> struts = {{1e3, 0}, {1e4, 0},  {1e5, 0},   {1e6, 0},   {1e7, 0},   {1e8, 0},
                                   {1e9, 0}, {1e10, 0}, {1e6, 1e2}, {1e6, 1e3}, {1e6, 1e4}, {1e6, 1e5}};

Benchmark benchmark(const Strut& strut, const StudyOptions& options)
{
    StudyOptions changed = options;
    // After the changes of --set, which may replace the whole force
    changed.set.push_back(fmt::format("/forces/0/stiffness={:g}", strut.k));
    changed.set.push_back(fmt::format("/forces/0/damping={:g}", strut.c));
    Benchmark c = make_benchmark(problem("double_pendulum_strut"), changed);
    c.problem.name = strut.name();
    return c;
}

void stiffness(StudyContext& s)
{
    for (const std::string& change : s.set)
        for (const char* entry : {"/forces/0/stiffness=", "/forces/0/damping="})
            if (change.starts_with(entry))
                s.refuse("it sets the stiffness and the damping of the strut, got --set " +
                         io::in_quotes(change));
    const WorkGrid grid(s,
                        {"rA-radau-5", "rA-genalpha", "rA-dp-5", "rA-rkmk-4", "rA-half-1-kick", "rA-rattle",
                         "ida-rp-baumgarte"},
                        {2e-2, 1e-2, 4e-3, 2e-3, 1e-3, 4e-4, 2e-4, 1e-4},
                        {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12});
    const Reference reference(s, grid.finest());
    std::vector<Benchmark> all;
    for (const Strut& strut : struts) all.push_back(benchmark(strut, s.options));
    const Sweep<WorkRun> runs = work_runs(s, grid, reference, all);

    const auto strut_of = [&](const WorkRun& run) { return struts[static_cast<size_t>(run.c - all.data())]; };
    const Columns<WorkRun> columns =
        Columns<WorkRun>{{"k", "k [N/m]", "{:g}", [=](const WorkRun& run) { return strut_of(run).k; }},
                         {"c", "c [N s/m]", "{:g}", [=](const WorkRun& run) { return strut_of(run).c; }},
                         column::integrator,
                         column::resolution,
                         column::h,
                         column::rtol,
                         column::reference} +
        columns_of_work();
    const std::vector<WorkSeries> series = series_of(runs);
    Table times({{"k"}, {"c"}, {"integrator"}, {"accuracy"}, {"cpu_seconds_needed"}, {"at_most"}});
    for (const double asked : accuracy) {
        std::vector<Table::Column> head = {{"k [N/m]", "{:.0e}"}, {"c [N s/m]", "{:g}"}};
        for (const lie::Scheme* scheme : grid.schemes) head.push_back({scheme->name});
        Table table(head);
        for (std::size_t k = 0; k < all.size(); ++k) {
            std::vector<Table::Cell> row = {struts[k].k, struts[k].c};
            for (const WorkSeries& of : series) {
                const WorkRun& first = *of.front();
                if (first.c != &all[k]) continue;
                const WorkNeeded w = work_needed(of, asked);
                row.emplace_back(milliseconds(w, 1));
                times.add(
                    {struts[k].k, struts[k].c, first.scheme->name, asked, w.seconds, w.at_most ? 1L : 0L});
                s.json["series"].push_back({{"k", struts[k].k},
                                            {"c", struts[k].c},
                                            {"integrator", first.scheme->name},
                                            {"asked_r", asked},
                                            {"cpu_seconds_needed", w.seconds},
                                            {"at_most", w.at_most}});
                if (asked == accuracy[0])
                    s.measured.push_back({.of = first.scheme->name + " with " + all[k].problem.name,
                                          .value = {{"cpu_seconds_needed", w.seconds}}});
            }
            table.add(row);
        }
        s.text << fmt::format("\nCPU time [ms] for an rms error of {:.0e} m; end time {:g} s\n", asked,
                              all.front().end);
        table.print(s.text);
    }
    s.text << fmt::format(
        "\nCPU time of a run: median of {} repeats; parallel runs: {}. <=: the fastest run already reaches "
        "this accuracy; -: not reached. Reference solution: {}\n",
        s.repeats, s.jobs_at_once, all.front().reference_name);
    s.files = {{"times.csv", times.csv()}};
    s.figures = {"stiffness.png"};
    s.table = columns.csv(runs);
    s.end_of_runs(run_pointers(runs));
}

const bool registered_stiffness = io::Registry<Study>::add(
    {.name = "stiffness",
     .answers = "error against CPU time over the stiffness and the damping of a strut",
     .options = options_of_integrators({"--reference", "--rtols", "--atol", "--repeats", "--strict"}),
     .keys = {"cpu_seconds_needed"},
     .files = {"times.csv", "stiffness.png"},
     .run = stiffness});

}  // namespace

}  // namespace hilda::studies
