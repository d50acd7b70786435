// SPDX-License-Identifier: GPL-3.0-or-later
/// Study long-time: energy and angular momentum of conservative models over long times, by decade of time.
///
/// E = T + V. L is the component along gravity of the angular momentum about the origin, Σ r × m ṙ + A J̄
/// ω̄; without gravity it is the length of this vector's change. L is constant in models that hang on or
/// stand on spherical joints at the origin, and in free ones. The energy error of a symmetric scheme
/// oscillates; that of others drifts. The decades end at the end of the run, a tenth of it, a hundredth, …;
/// each has the mean and the largest change since the start. The drift of a run is the mean of the last
/// tenth minus that of the first tenth, which the oscillation does not affect.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "studies/framework/curve.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::studies {

namespace {

constexpr long fewest_steps = 100;  // of the first decade

/// Mean and largest magnitude of a quantity
struct Average {
    double sum = 0, largest = 0;
    long count = 0;

    void add(double x) { sum += x, largest = std::max(largest, std::abs(x)), ++count; }
    double mean() const { return count > 0 ? sum / static_cast<double>(count) : std::nan(""); }
};

class LongTimeRecorder final : public lie::Observer {
public:
    LongTimeRecorder(const dae::Model& model, const lie::TimeGrid& grid)
        : model(model), last(grid.steps), gravity(model.gravity)
    {
        for (long n = last; n >= fewest_steps; n /= 10) ends.insert(ends.begin(), n);
        if (ends.empty()) ends = {last};
        energy.resize(ends.size()), momentum.resize(ends.size());
    }

    void accepted(const lie::State& x, long n, int) override
    {
        dae::check_dropped_rows(model, x);
        const double E = lie::energy(model, x);
        const lie::Vec3 L = angular_momentum(x);
        if (n == 0) E_0 = E, L_0 = L;
        kinetic = std::max(kinetic, E - model.potential_energy(x));
        size = std::max(size, L.norm());
        if (n == 0) return;
        const double dL = gravity.norm() > 0 ? (L - L_0).dot(gravity.normalized()) : (L - L_0).norm();
        while (decade + 1 < ends.size() && n > ends[decade]) end_decade(time_before);
        time_before = x.t;
        energy[decade].add(E - E_0), momentum[decade].add(dL);
        if (10 * n <= last) first_tenth.add(E - E_0);
        if (10 * n > 9 * last) last_tenth.add(E - E_0);
        if (n == last) end_decade(x.t);
    }

    Curve decades{{"t", "energy_mean", "energy_max", "momentum_mean", "momentum_max"}};
    Average first_tenth, last_tenth;  ///< of E - E(0) in these parts of the run [J]
    double kinetic = 0;               ///< largest T [J]
    double size = 0;                  ///< largest angular momentum [N m s]

private:
    lie::Vec3 angular_momentum(const lie::State& x) const
    {
        lie::Vec3 L = lie::Vec3::Zero();
        for (std::size_t b = 0; b < x.body.size(); ++b) {
            const lie::Motion& body = x.body[b];
            L += model.mass().m[b] * body.r.cross(body.rdot) +
                 body.A * (model.mass().J_bar[b] * body.omega_bar);
        }
        return L;
    }
    void end_decade(double t)
    {
        const Average &E = energy[decade], &L = momentum[decade];
        decades.add({t, E.mean(), E.largest, L.mean(), L.largest});
        ++decade;
    }

    const dae::Model& model;
    const long last;
    const lie::Vec3 gravity;
    std::vector<long> ends;  ///< last node of each decade
    std::vector<Average> energy, momentum;
    std::size_t decade = 0;
    double E_0 = 0, time_before = 0;  ///< time of the node before
    lie::Vec3 L_0 = lie::Vec3::Zero();
};

struct LongTimeRun : Run {
    double drift = 0, largest = 0, kinetic = 0;  ///< of E [J]
    double momentum = 0, size = 0;               ///< largest change of L, largest L [N m s]
    Curve decades = {};

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(drift), a.value(largest), a.value(kinetic), a.value(momentum), a.value(size);
        decades.transfer(a);
    }
};

void compute(LongTimeRun& run, const lie::Settings& settings)
{
    LongTimeRecorder recorder(*run.c->started->model, lie::TimeGrid::over(run.c->end, run.h, run.c->end));
    lie::Observer* observers[] = {&recorder};
    march(run, settings, observers);
    const auto of_complete_run = [&](double value) { return run.failed() ? std::nan("") : value; };
    run.drift = of_complete_run(recorder.last_tenth.mean() - recorder.first_tenth.mean());
    run.largest = of_complete_run(recorder.decades.largest("energy_max"));
    run.momentum = of_complete_run(recorder.decades.largest("momentum_max"));
    run.kinetic = recorder.kinetic, run.size = recorder.size;
    run.decades = std::move(recorder.decades);
}

void long_time(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-3});
    const std::vector<Benchmark> all =
        s.benchmarks({"n_pendulum_2_spin", "heavy_top"}, steps, [](const dae::Description&) { return 100.; });
    Sweep<LongTimeRun> runs(all,
                            s.fixed_step_schemes({"rA-half-2", "rA-half-1-kick", "rA-half-1-momentum",
                                                  "rA-rattle", "rA-rattle-4", "rA-rattle-6", "rA-rkmk-4"}),
                            steps);
    runs.compute(s, [&](LongTimeRun& run) { compute(run, s.settings); });

    const Columns<LongTimeRun> columns = {
        column::problem,
        column::integrator,
        column::h,
        column::end,
        {"energy_drift", "drift of E [J]", "{:+.2e}", &LongTimeRun::drift},
        {"energy_drift_relative", "/ max T", "{:+.1e}",
         [](const auto& run) { return run.drift / run.kinetic; }},
        {"energy_max", "max |E-E0| [J]", "{:.2e}", &LongTimeRun::largest},
        {"max_kinetic", "max T [J]", "{:.5g}", &LongTimeRun::kinetic},
        {"momentum_max", "max |L-L0| [N m s]", "{:.2e}", &LongTimeRun::momentum},
        {"momentum_max_relative", "/ max L", "{:.1e}",
         [](const auto& run) { return run.momentum / run.size; }},
        column::steps,
        column::iterations,
        column::cpu_seconds,
        column::status};
    for (const Benchmark& c : all) {
        s.text << fmt::format("\n{}, end time {:g} s: energy, and angular momentum along gravity\n",
                              c.problem.name, c.end);
        columns.print(s.text, runs.of(c),
                      {"integrator", "h", "energy_drift", "energy_drift_relative", "energy_max",
                       "momentum_max", "momentum_max_relative", "status"});
        s.figures.push_back("long-time-" + c.problem.name + ".png");
    }
    s.json["runs"] = columns.array(
        runs, {"energy_drift", "energy_drift_relative", "energy_max", "max_kinetic", "momentum_max"});
    CurveTable decades({"problem", "integrator", "h"},
                       {"t", "energy_mean", "energy_max", "momentum_mean", "momentum_max"});
    for (const LongTimeRun& run : runs)
        decades.add({run.c->problem.name, run.scheme->name, run.h}, run.decades);
    s.files = {{"decades.csv", decades.csv()}};
    s.results(columns, runs);
}

const bool registered_long_time = io::Registry<Study>::add(
    {.name = "long-time",
     .answers = "energy and angular momentum of conservative models over long times, by decade of time",
     .options = options_of_models({"--strict", "--shard"}),
     .keys = {"energy_drift", "energy_drift_relative", "energy_max", "momentum_max", "momentum_max_relative"},
     .files = {"decades.csv", "long-time-PROBLEM.png"},
     .run = long_time});

}  // namespace

}  // namespace hilda::studies
