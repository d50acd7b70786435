// SPDX-License-Identifier: GPL-3.0-or-later
/// Energy over time (Fang 2022, Fig. 3.5), and its balance for damped and driven models.
///
/// For each problem, scheme and step size, E(t) - E(0) is evaluated at every node. E = T + V is the total
/// energy with all velocities at the time of the node. For a conservative model this is the error of the
/// energy. For a model with dampers, drivers, friction or other loads without potential the error is E(t) -
/// E(0) - W(t), where W is their work (WorkBalance). The table contains the values at the end of the run and
/// the largest ones, in J and relative to the largest kinetic energy of the run. energy.csv contains the
/// curves.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "studies/experiments/chapter3/work_balance.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/curve.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

// The integral of the work has its full order from this node on (NodeIntegral).
constexpr long first_precise = 3;
constexpr long max_energy_rows = 1000;  // limit on the rows per run in energy.csv

/// Records the energy and the work of every node; the curve keeps only the rows of the grid.
class EnergyRecorder final : public lie::Observer {
public:
    EnergyRecorder(const dae::Model& model, const lie::TimeGrid& grid) : work(model), model(model), grid(grid)
    {}

    void accepted(const lie::State& x, long n, int) override
    {
        dae::check_dropped_rows(model, x);
        end = lie::energy(model, x);
        if (n == 0) start = end;
        work.add(x);
        error = end - start - work.work();
        kinetic = std::max(kinetic, end - model.potential_energy(x));
        largest = std::max(largest, std::abs(end - start));
        if (n == 0 || n >= first_precise || n == grid.steps)
            largest_error = std::max(largest_error, std::abs(error));
        if (grid.is_row(n)) curve.add({x.t, end, end - start, work.work(), error});
    }

    double start = 0, end = 0;  ///< E at the first and at the last node [J]
    double largest = 0;         ///< largest |E - E(0)| [J]
    double error = 0;           ///< E - E(0) - W at the last node [J]
    double largest_error = 0;   ///< largest |E - E(0) - W| [J], without the first two steps
    double kinetic = 0;         ///< largest T [J]
    Curve curve{{"t", "energy", "drift", "work", "balance"}};
    WorkBalance work;

private:
    const dae::Model& model;
    const lie::TimeGrid grid;
};

struct EnergyRun : Run {
    double start = 0, drift = 0, largest = 0, kinetic = 0;        ///< [J]
    double loads = 0, drivers = 0, error = 0, largest_error = 0;  ///< works, E - E(0) - W [J]
    std::vector<std::string> sources = {};  ///< of work; empty: the model is conservative
    Curve curve = {};

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(start), a.value(drift), a.value(largest), a.value(kinetic);
        a.value(loads), a.value(drivers), a.value(error), a.value(largest_error);
        size_t count = sources.size();
        a.count(count, sizeof(size_t));
        sources.resize(count);
        for (std::string& source : sources) a.list(source);
        curve.transfer(a);
    }
};

void compute(EnergyRun& run, const lie::Settings& settings)
{
    EnergyRecorder recorder(
        *run.c->started->model,
        lie::TimeGrid::over(run.c->end, run.h, run.c->end / static_cast<double>(max_energy_rows)));
    lie::Observer* observers[] = {&recorder};
    march(run, settings, observers);
    run.start = recorder.start;
    const auto of_complete_run = [&](double value) { return run.failed() ? std::nan("") : value; };
    run.drift = of_complete_run(recorder.end - recorder.start);
    run.largest = of_complete_run(recorder.largest);
    run.loads = of_complete_run(recorder.work.loads());
    run.drivers = of_complete_run(recorder.work.drivers());
    run.error = of_complete_run(recorder.error);
    run.largest_error = of_complete_run(recorder.largest_error);
    run.sources = recorder.work.sources();
    run.kinetic = recorder.kinetic;
    run.curve = std::move(recorder.curve);
}

/// What does work in the runs of a problem, in the order of the first run; empty for a conservative model
std::vector<std::string> sources_of(const std::vector<const EnergyRun*>& runs)
{
    std::vector<std::string> all;
    for (const EnergyRun* run : runs)
        for (const std::string& source : run->sources)
            if (std::find(all.begin(), all.end(), source) == all.end()) all.push_back(source);
    return all;
}

/// Fig. 3.5: with the double pendulum the fully implicit scheme loses energy, the half-implicit scheme does
/// not.
std::vector<Criterion> criteria_of_energy(const std::vector<EnergyRun>& runs)
{
    std::vector<Criterion> all;
    for (const EnergyRun& run : runs) {
        if (run.c->problem.name != "double_pendulum") continue;
        CriteriaOf of{.of = " over the largest kinetic energy, " + run.name(), .list = all};
        if (run.scheme->name == "rA-half-1")
            of.between("largest change of the energy", run.largest / run.kinetic, 0, 0.01);
        if (run.scheme->name == "rA-full-1")
            of.between("change of the energy at the end", run.drift / run.kinetic, -1, -0.05);
    }
    return all;
}

constexpr size_t most_named = 8;  // sources of work that are named in the text

void energy(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-3});
    const std::vector<Benchmark> all = s.benchmarks({"double_pendulum", "n_pendulum_2_spin"}, steps,
                                                    [](const dae::Description&) { return 30.; });
    Sweep<EnergyRun> runs(all, s.fixed_step_schemes(), steps);
    runs.compute(s, [&](EnergyRun& run) { compute(run, s.settings); });

    const Columns<EnergyRun> columns = {
        column::problem,
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
        {"work_loads", "W loads [J]", "{:+.5g}", &EnergyRun::loads},
        {"work_drivers", "W drivers [J]", "{:+.5g}", &EnergyRun::drivers},
        {"end_balance", "E-E0-W at end [J]", "{:+.4g}", &EnergyRun::error},
        {"max_balance", "max |E-E0-W| [J]", "{:.4g}", &EnergyRun::largest_error},
        {"max_balance_relative", "max / max T", "{:.1e}",
         [](const auto& run) { return run.largest_error / run.kinetic; }},
        column::steps,
        column::iterations,
        column::cpu_seconds,
        column::status};
    io::Json& models = s.json["models"] = io::Json::array();
    for (const Benchmark& c : all) {
        const std::vector<std::string> sources = sources_of(runs.of(c));
        models.push_back(
            {{"problem", c.problem.name}, {"conservative", sources.empty()}, {"work_of", sources}});
        const bool conservative = sources.empty();
        s.text << fmt::format("\n{}, end time {:g} s: {}\n", c.problem.name, c.end,
                              conservative ? "change of the energy E = T + V (conservative model)"
                                           : "balance of the energy E = T + V with the work W");
        if (!conservative)
            s.text << fmt::format(
                "not conservative: {}{}\n",
                fmt::join(sources.begin(),
                          sources.begin() + static_cast<std::ptrdiff_t>(std::min(most_named, sources.size())),
                          ", "),
                sources.size() > most_named ? fmt::format(" and {} more", sources.size() - most_named) : "");
        if (conservative)
            columns.print(s.text, runs.of(c),
                          {"integrator", "h", "end_drift", "max_drift", "end_drift_relative",
                           "max_drift_relative", "max_kinetic", "status"});
        else
            columns.print(s.text, runs.of(c),
                          {"integrator", "h", "end_drift", "work_loads", "work_drivers", "end_balance",
                           "max_balance", "max_balance_relative", "max_kinetic", "status"});
        s.figures.push_back("energy-" + c.problem.name + ".png");
    }
    s.json["runs"] = columns.array(runs, {"energy_start", "end_drift", "max_drift", "work_loads",
                                          "work_drivers", "end_balance", "max_balance", "max_kinetic"});
    CurveTable curves({"problem", "integrator", "h"}, {"t", "energy", "drift", "work", "balance"});
    for (const EnergyRun& run : runs) curves.add({run.c->problem.name, run.scheme->name, run.h}, run.curve);
    s.files = {{"energy.csv", curves.csv()}};
    s.results(columns, runs);
    if (s.check) s.evaluate(criteria_of_energy(runs));
}

const bool registered_energy = io::Registry<Study>::add(
    {.name = "energy",
     .answers = "energy over time: its drift in conservative models (Fig. 3.5), its balance with the work in "
                "damped and driven ones",
     .options = options_of_models({"--check", "--strict", "--shard"}),
     .keys = {"end_drift", "max_drift", "max_drift_relative", "end_balance", "max_balance",
              "max_balance_relative"},
     .files = {"energy.csv", "energy-PROBLEM.png"},
     .run = energy});

}  // namespace

}  // namespace hilda::studies
