// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of convergence of the half-implicit schemes for evolving contacts (Fang 2022, Ch. 5).
///
/// rA-half-1 is the scheme of the dissertation. It starts with v_{-1/2} = v_0 and evaluates the gyroscopic
/// torque half a step late, so it is of first order. A ball has no gyroscopic torque; there the start alone
/// limits the order. rA-half-1-kick starts with a half step of the accelerations and extrapolates the
/// velocities to the node (leapfrog). rA-half-1-momentum balances the angular momentum and needs no
/// gyroscopic torque.
///
/// The errors are the largest errors of position, orientation, contact points and normal force over the
/// instants of the reference solution. The order is fitted through steps up to 5e-3 s. --check compares the
/// fitted orders with the declared ones and returns exit code 6 if an acceptance criterion fails.

#include "dae/model_file.hpp"
#include "studies/experiments/chapter5/evolving_errors.hpp"
#include "studies/framework/convergence_study.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

namespace norm = evolving_norm;

constexpr double rounding = 1e-9;  // smaller errors are not used in the fit: rounding in F_N is ε m/h²

const ConvergenceStudy study{.norms = {norm::names.begin(), norm::names.end()},
                             .asymptotic_step = 5e-3,
                             .least_points = 2,
                             .prefix_of_errors = "error_"};

void compute(ErrorRun& run, lie::Settings settings)
{
    ReferenceErrors comparison(*run.c, run.h);
    lie::Observer* observers[] = {&comparison};
    settings.tolerance = std::min(settings.tolerance, 1e-13);  // error of F_N: Newton error times m/h²
    march(run, settings, observers);
    run.constraint_norm = comparison.constraint_norm;
    for (const double e : comparison.error) {
        run.at_floor[run.error.size()] = !(e > rounding);
        run.error.push_back(run.failed() ? std::nan("") : e);
    }
}

void print(const Series& series, StudyText& out)
{
    const ErrorRun& first = *series.front();
    out << fmt::format("\n{}, {}; reference solution: {}\n", first.c->problem.name, first.scheme->name,
                       first.c->reference_name);
    std::vector<Table::Column> columns = {{"h [s]", "{:.2e}"}};
    for (const char* head : {"r [m]", "A", "alpha [m]", "F_N [N]"}) {
        columns.push_back({head, "{:.3e}"});
        columns.push_back({"order", "{:.2f}"});
    }
    columns.insert(columns.end(), {{"iter", "{:.2f}"}, {"|Phi|", "{:.1e}"}, {"status"}});
    Table table(columns);
    for (const ErrorRun* run : series) {
        std::vector<Table::Cell> row = {run->h};
        for (int n = 0; n < norm::count; ++n) row.insert(row.end(), {run->error[n], run->order[n]});
        row.insert(row.end(), {run->statistics.iterations_per_step(), run->constraint_norm, run->status});
        table.add(row);
    }
    table.print(out);
}

void print_fits(const std::vector<Series>& all, StudyText& out)
{
    Table table({{"problem"},
                 {"integrator"},
                 {"r", "{:.2f}"},
                 {"A", "{:.2f}"},
                 {"alpha", "{:.2f}"},
                 {"F_N", "{:.2f}"}});
    for (const Series& series : all) {
        std::vector<Table::Cell> row = {series.front()->c->problem.name, series.front()->scheme->name};
        for (int n = 0; n < norm::count; ++n) row.emplace_back(study.fit(series, n));
        table.add(row);
    }
    out << "\nfitted orders, steps up to 5e-3 s\n";
    table.print(out);
}

/// Acceptance criteria: the declared orders
std::vector<Criterion> criteria(const std::vector<Series>& all)
{
    std::vector<Criterion> checks;
    for (const Series& series : all) {
        const lie::Scheme& scheme = *series.front()->scheme;
        const bool ball = series.front()->c->problem.name.find("ball") != std::string::npos;
        for (const int n : {norm::r, norm::alpha, norm::F_N}) {
            const double order = n == norm::F_N ? scheme.order_lambda : scheme.order;
            checks.push_back(criterion(fmt::format("order of {}, {} by {}", norm::names[n],
                                                   series.front()->c->problem.name, scheme.name),
                                       study.fit(series, n), order, ball ? 0.03 : 0.05));
        }
    }
    return checks;
}

/// The benchmarks, with the normal rows of --normal-rows
std::vector<Benchmark> selected_benchmarks(const StudyContext& s)
{
    std::vector<Benchmark> all;
    const std::vector<std::string> otherwise = {"ball_in_bowl", "ball_in_bowl_xy", "rolling_ball_in_bowl",
                                                "rolling_ball_in_bowl_xy", "wobbling_ellipsoid"};
    for (const std::string& name : s.problems.empty() ? otherwise : s.problems) {
        all.push_back(make_benchmark(problem_or_file(name), s.options));
        if (run::evolving_contacts(*all.back().started->model).empty())
            s.refuse(name + " has no evolving contact, which this study needs");
    }
    return all;
}

void evolving_order(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-2, 5e-3, 2.5e-3, 1.25e-3});
    const Schemes schemes = s.fixed_step_schemes({"rA-half-1", "rA-half-1-kick", "rA-half-1-momentum"});
    const Reference reference(s, finest(schemes, steps.back()));
    std::vector<Benchmark> benchmarks = selected_benchmarks(s);
    reference.evaluate(benchmarks, steps);
    const Sweep<ErrorRun> runs =
        study.runs(s, benchmarks, schemes, steps, [&](ErrorRun& run) { compute(run, s.settings); });
    const std::vector<Series> all = series_of(runs);

    const Columns<ErrorRun> columns = Columns<ErrorRun>{column::problem, column::integrator, column::h} +
                                      study.errors() + study.orders() +
                                      Columns<ErrorRun>{column::steps,
                                                        column::iterations,
                                                        {"constraint_norm", &ErrorRun::constraint_norm},
                                                        column::cpu_seconds,
                                                        column::status};
    for (const Series& series : all) {
        print(series, s.text);
        s.measured.push_back(study.measured(series));
        s.json["series"].push_back(
            study.json(series, columns, {}, {{"reference", series.front()->c->reference_name}}));
    }
    print_fits(all, s.text);
    for (const Benchmark& c : benchmarks) s.figures.push_back(s.name + '-' + c.problem.name + ".png");
    s.table = columns.csv(runs);
    s.end_of_runs(run_pointers(runs));
    if (s.check) s.evaluate(criteria(all));
}

const bool registered_evolving_order = io::Registry<Study>::add(
    {.name = "evolving-order",
     .answers = "order of convergence of the schemes for evolving contacts (Ch. 5)",
     .options = options_of_models({"--reference", "--check", "--normal-rows", "--strict", "--shard"}),
     .keys = study.keys(),
     .files = {"evolving-order-PROBLEM.png"},
     .run = evolving_order});

}  // namespace

}  // namespace hilda::studies
