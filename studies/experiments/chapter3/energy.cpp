// SPDX-License-Identifier: GPL-3.0-or-later
/// Energy of undamped systems over time (Fang 2022, Fig. 3.5).
///
/// For each problem, scheme and step size, E(t) - E(0) is evaluated at every node. E = T + V is the total
/// energy with all velocities at the time of the node. The table contains the change at the end of the run
/// and the largest change, in J and relative to the largest kinetic energy of the run. energy.csv contains
/// the curves.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
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

const std::string kind = "energy";
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
        if (grid.is_row(n)) curve.emplace_back(x.t, end);
    }

    double start = 0, end = 0;  ///< E at the first and at the last node [J]
    double largest = 0;         ///< largest |E - E(0)| [J]
    double kinetic = 0;         ///< largest T [J]
    std::vector<std::pair<double, double>> curve;

private:
    const dae::Model& model;
    const lie::TimeGrid grid;
};

struct EnergyRun : Run {
    double start = 0, drift = 0, largest = 0, kinetic = 0;  ///< [J]
    std::vector<std::pair<double, double>> curve;           ///< t [s], E [J]
};

void compute(EnergyRun& run, const StudyOptions& options)
{
    EnergyRecorder recorder(
        *run.c->started->model,
        lie::TimeGrid::over(run.c->end, run.h, run.c->end / static_cast<double>(max_rows)));
    lie::Observer* observers[] = {&recorder};
    march(run, options.settings, observers);
    run.start = recorder.start;
    run.drift = run.failed() ? std::nan("") : recorder.end - recorder.start;
    run.largest = run.failed() ? std::nan("") : recorder.largest;
    run.kinetic = recorder.kinetic;
    run.curve = std::move(recorder.curve);
}

Table as_table(const std::vector<EnergyRun>& runs)
{
    Table table({{"problem"},
                 {"integrator"},
                 {"h"},
                 {"end"},
                 {"energy_start"},
                 {"end_drift"},
                 {"max_drift"},
                 {"max_kinetic"},
                 {"end_drift_relative"},
                 {"max_drift_relative"},
                 {"steps"},
                 {"iterations_per_step"},
                 {"cpu_seconds"},
                 {"status"}});
    for (const EnergyRun& run : runs)
        table.add({run.c->problem.name, run.scheme->name, run.h, run.c->end, run.start, run.drift,
                   run.largest, run.kinetic, run.drift / run.kinetic, run.largest / run.kinetic,
                   static_cast<double>(run.statistics.steps), run.statistics.iterations_per_step(),
                   run.seconds, run.status});
    return table;
}

void print(const std::vector<EnergyRun>& runs, const Benchmark& c, std::ostream& out)
{
    Table table({{"integrator"},
                 {"h [s]", "{:.1e}"},
                 {"E-E0 at end [J]", "{:+.4g}"},
                 {"max |E-E0| [J]", "{:.4g}"},
                 {"end / max T", "{:+.1e}"},
                 {"max / max T", "{:.1e}"},
                 {"max T [J]", "{:.5g}"},
                 {"status"}});
    for (const EnergyRun& run : runs)
        if (run.c == &c)
            table.add({run.scheme->name, run.h, run.drift, run.largest, run.drift / run.kinetic,
                       run.largest / run.kinetic, run.kinetic, run.status});
    out << fmt::format("\n{}, end time {:g} s: change of the energy E = T + V\n", c.problem.name, c.end);
    table.print(out);
}

std::string curves(const std::vector<EnergyRun>& runs)
{
    std::string csv = "problem,integrator,h,t,energy,drift\n";
    for (const EnergyRun& run : runs)
        for (const auto& [t, E] : run.curve) {
            csv += io::csv_field(run.c->problem.name) + ',' + io::csv_field(run.scheme->name);
            for (const double value : {run.h, t, E, E - run.start}) {
                csv += ',';
                io::append_number(csv, value);
            }
            csv += '\n';
        }
    return csv;
}

io::Json as_json(const std::vector<EnergyRun>& runs)
{
    io::Json rows = io::Json::array();
    for (const EnergyRun& run : runs) {
        io::Json row = as_json(static_cast<const Run&>(run));
        row.update({{"energy_start", run.start},
                    {"end_drift", run.drift},
                    {"max_drift", run.largest},
                    {"max_kinetic", run.kinetic}});
        rows.push_back(row);
    }
    return rows;
}

int energy(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"end_drift", "max_drift", "max_drift_relative"});
    const std::vector<double> steps = steps_or(options, {1e-3});
    const Schemes schemes = fixed_step_schemes(kind, options);
    const std::vector<Benchmark> all = benchmarks(kind, options, {"double_pendulum", "n_pendulum_2_spin"},
                                                  [](const dae::Description&) { return 30.; });
    std::vector<EnergyRun> runs;
    for (const Benchmark& c : all) {
        check_steps(kind, c, steps);
        for (const lie::Scheme* s : schemes)
            for (const double h : steps) {
                EnergyRun run;
                run.c = &c, run.scheme = s, run.h = h;
                runs.push_back(run);
            }
    }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"runs", as_json(runs)}}};
    output.files = {{"energy.csv", curves(runs)}};
    for (const Benchmark& c : all) {
        print(runs, c, output.text);
        output.figures.push_back("energy-" + c.problem.name + ".png");
    }
    std::vector<Measured> measurements;
    for (const EnergyRun& run : runs)
        measurements.push_back({.of = run.name(),
                                .value = {{"end_drift", run.drift},
                                          {"max_drift", run.largest},
                                          {"max_drift_relative", run.largest / run.kinetic}}});
    return finish(options, output, run_pointers(runs), measurements);
}

const bool registered = register_study(
    Study{.kind = kind, .answers = "energy drift of undamped systems over time (Fig. 3.5)", .run = energy});

}  // namespace

}  // namespace hilda::studies
