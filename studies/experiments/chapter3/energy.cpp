// SPDX-License-Identifier: GPL-3.0-or-later
/// Energy of undamped systems over time (Fang 2022, Fig. 3.5).
///
/// For each problem, scheme and step size, E(t) - E(0) is evaluated at every node. E = T + V is the total
/// energy with all velocities at the time of the node. The table contains the change at the end of the run
/// and the largest change, in J and relative to the largest kinetic energy of the run. energy.csv contains
/// the curves.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "studies/framework/curve.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

namespace hilda::studies {

namespace {

constexpr long max_rows = 1000;  // limit on the rows per run in energy.csv

/// Records the energy of every node; the curve keeps only the rows of the grid.
class EnergyRecorder final : public lie::Observer {
public:
    EnergyRecorder(const dae::Model& model, const lie::TimeGrid& grid) : model(model), grid(grid) {}

    void accepted(const lie::State& x, long n, int) override
    {
        dae::check_dropped_rows(model, x);
        end = lie::energy(model, x);
        if (n == 0) start = end;
        kinetic = std::max(kinetic, end - model.potential_energy(x));
        largest = std::max(largest, std::abs(end - start));
        if (grid.is_row(n)) curve.add({x.t, end, end - start});
    }

    double start = 0, end = 0;  ///< E at the first and at the last node [J]
    double largest = 0;         ///< largest |E - E(0)| [J]
    double kinetic = 0;         ///< largest T [J]
    Curve curve{{"t", "energy", "drift"}};

private:
    const dae::Model& model;
    const lie::TimeGrid grid;
};

struct EnergyRun : Run {
    double start = 0, drift = 0, largest = 0, kinetic = 0;  ///< [J]
    Curve curve = {};

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(start), a.value(drift), a.value(largest), a.value(kinetic), curve.transfer(a);
    }
};

void compute(EnergyRun& run, const lie::Settings& settings)
{
    EnergyRecorder recorder(
        *run.c->started->model,
        lie::TimeGrid::over(run.c->end, run.h, run.c->end / static_cast<double>(max_rows)));
    lie::Observer* observers[] = {&recorder};
    march(run, settings, observers);
    run.start = recorder.start;
    run.drift = run.failed() ? std::nan("") : recorder.end - recorder.start;
    run.largest = run.failed() ? std::nan("") : recorder.largest;
    run.kinetic = recorder.kinetic;
    run.curve = std::move(recorder.curve);
}

void energy(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-3});
    const std::vector<Benchmark> all = s.benchmarks({"double_pendulum", "n_pendulum_2_spin"}, steps,
                                                    [](const dae::Description&) { return 30.; });
    Sweep<EnergyRun> runs(all, s.fixed_step_schemes(), steps);
    runs.compute(s, [&](EnergyRun& run) { compute(run, s.options.settings); });

    const Columns<EnergyRun> columns = {column::problem,
                                        column::integrator,
                                        column::h,
                                        column::end,
                                        {"energy_start", &EnergyRun::start},
                                        {"end_drift", "E-E0 at end [J]", "{:+.4g}", &EnergyRun::drift},
                                        {"max_drift", "max |E-E0| [J]", "{:.4g}", &EnergyRun::largest},
                                        {"max_kinetic", "max T [J]", "{:.5g}", &EnergyRun::kinetic},
                                        {"end_drift_relative", "end / max T", "{:+.1e}",
                                         [](const auto& run) { return run.drift / run.kinetic; }},
                                        {"max_drift_relative", "max / max T", "{:.1e}",
                                         [](const auto& run) { return run.largest / run.kinetic; }},
                                        column::steps,
                                        column::iterations,
                                        column::cpu_seconds,
                                        column::status};
    for (const Benchmark& c : all) {
        s.text << fmt::format("\n{}, end time {:g} s: change of the energy E = T + V\n", c.problem.name,
                              c.end);
        columns.print(s.text, runs.of(c),
                      {"integrator", "h", "end_drift", "max_drift", "end_drift_relative",
                       "max_drift_relative", "max_kinetic", "status"});
        s.figures.push_back("energy-" + c.problem.name + ".png");
    }
    s.json["runs"] = columns.array(runs, {"energy_start", "end_drift", "max_drift", "max_kinetic"});
    CurveTable curves({"problem", "integrator", "h"}, {"t", "energy", "drift"});
    for (const EnergyRun& run : runs) curves.add({run.c->problem.name, run.scheme->name, run.h}, run.curve);
    s.files = {{"energy.csv", curves.csv()}};
    s.results(columns, runs);
}

const bool registered =
    io::Registry<Study>::add({.name = "energy",
                              .answers = "energy drift of undamped systems over time (Fig. 3.5)",
                              .keys = {"end_drift", "max_drift", "max_drift_relative"},
                              .files = {"energy.csv", "energy-PROBLEM.png"},
                              .run = energy});

}  // namespace

}  // namespace hilda::studies
