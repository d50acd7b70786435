// SPDX-License-Identifier: GPL-3.0-or-later
/// Quality of the solution over the tolerance of Newton's method.                  Fang (2022), Sec. 3.8.2
///
/// Each integrator runs with each of the tolerances 1e-3 ... 1e-13 at one step. The table has the errors of
/// errors.hpp, the largest constraint norm, the drift of the energy and the Newton iterations per step. The
/// tolerance that is enough is the largest one for which the errors of r, v and Q exceed those with the
/// smallest tolerance by at most 1 %, or are below 1e-9.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::studies {

namespace {

constexpr double more_error = 0.01;  ///< allowed by the tolerance that is enough, relative
constexpr double least_error =
    1e-9;  ///< not compared: where drivers prescribe the motion, r follows the tolerance

struct ToleranceRun : Run {
    double tolerance = 0;
    Errors errors = {};
    double constraint_norm = 0;

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(errors.value), a.value(errors.instants), a.value(constraint_norm);
    }
    double error(int n) const { return errors.value[static_cast<size_t>(n)]; }
};

using ToleranceSeries = std::vector<const ToleranceRun*>;

void compute(ToleranceRun& run, lie::Settings settings)
{
    settings.tolerance = run.tolerance;
    Run& common = run;
    EvaluatedRun evaluated{common};
    evaluate(evaluated, settings);
    common = static_cast<const Run&>(evaluated);
    run.errors = evaluated.errors;
    run.constraint_norm = run.failed() ? std::nan("") : evaluated.constraint_norm;
}

/// The largest tolerance from which on all smaller ones give the errors of the smallest; NaN if the run with
/// the smallest failed
double enough(const ToleranceSeries& series)
{
    const ToleranceRun& best = *series.back();
    double tolerance = best.failed() ? std::nan("") : best.tolerance;
    for (auto run = series.rbegin(); run != series.rend() && !(*run)->failed(); ++run) {
        for (const int n : {norm::r, norm::v, norm::Q})
            if ((*run)->error(n) > std::max((1 + more_error) * best.error(n), least_error)) return tolerance;
        tolerance = (*run)->tolerance;
    }
    return tolerance;
}

void tolerance(StudyContext& s)
{
    if (s.is_given("--tolerance"))
        s.refuse("it runs with the tolerances 1e-3 to 1e-13; --tolerance is for other studies");
    const double h = s.one_step(1e-3);
    const Schemes schemes = s.fixed_step_schemes(
        {"rA-full-1", "rA-half-1", "rA-half-2", "rA-half-1-momentum", "rA-genalpha", "rA-rattle"});
    std::vector<double> tolerances;
    for (int k = 3; k <= 13; ++k) tolerances.push_back(std::pow(10., -k));
    std::vector<Benchmark> all = s.benchmarks({"double_pendulum", "slider_crank", "four_link"}, {h});
    Reference(s, finest(schemes, h, 0)).evaluate(all, {h});

    Sweep<ToleranceRun> runs;
    for (const Benchmark& c : all)
        for (const lie::Scheme* scheme : schemes)
            for (const double of : tolerances) runs.add(c, *scheme, h).tolerance = of;
    runs.compute(s, [&](ToleranceRun& run) { compute(run, s.settings); });

    const auto error = [](int n) { return [n](const ToleranceRun& run) { return run.error(n); }; };
    const Columns<ToleranceRun> columns = {
        column::problem,
        column::integrator,
        column::h,
        {"tolerance", "tolerance", "{:.0e}", &ToleranceRun::tolerance},
        {"r", "r [m]", error(norm::r)},
        {"A", error(norm::A)},
        {"v", "v [m/s]", error(norm::v)},
        {"omega", error(norm::omega)},
        {"Q", "Q", error(norm::Q)},
        {"constraint_norm", "residual", "{:.1e}", &ToleranceRun::constraint_norm},
        column::iterations,
        column::reference,
        column::cpu_seconds,
        column::status};
    for (const Benchmark& c : all) {
        s.text << fmt::format("\n{}, end time {:g} s, h = {:g} s; reference solution: {}\n", c.problem.name,
                              c.end, h, c.reference_name);
        columns.print(
            s.text, runs.of(c),
            {"integrator", "tolerance", "r", "v", "Q", "constraint_norm", "iterations_per_step", "status"});
        s.figures.push_back("tolerance-" + c.problem.name + ".png");
    }
    Table largest({{"problem"}, {"integrator"}, {"tolerance that is enough", "{:.0e}"}});
    for (const ToleranceSeries& series : series_of(runs)) {
        const ToleranceRun& first = *series.front();
        largest.add({first.c->problem.name, first.scheme->name, enough(series)});
        s.json["series"].push_back(
            {{"problem", first.c->problem.name},
             {"integrator", first.scheme->name},
             {"enough", enough(series)},
             {"rows", columns.array(
                          series, {"tolerance", "r", "v", "Q", "constraint_norm", "iterations_per_step"})}});
    }
    s.text << fmt::format(
        "\nErrors of r, v and Q at most {:g} % above those of the smallest tolerance, or below {:g}:\n",
        100 * more_error, least_error);
    largest.print(s.text);
    s.results(columns, runs);
}

const bool registered_tolerance = io::Registry<Study>::add(
    {.name = "tolerance",
     .answers = "errors and Newton iterations over the tolerance of Newton's method (Sec. 3.8.2)",
     .options = options_of_models({"--reference", "--strict", "--shard"}),
     .keys = {"r", "v", "Q"},
     .files = {"tolerance-PROBLEM.png"},
     .run = tolerance});

}  // namespace

}  // namespace hilda::studies
