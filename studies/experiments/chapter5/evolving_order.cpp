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
#include "io/error.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "studies/experiments/chapter5/evolving_errors.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/named_model.hpp"
#include "studies/running/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace hilda::studies {

namespace {

namespace norm = evolving_norm;

const std::string kind = "evolving-order";
constexpr double largest_fitted_step = 5e-3;  // steps above this are not used in the fit [s]
constexpr double rounding = 1e-9;  // smaller errors are not used in the fit: rounding in F_N is ε m/h²

struct OrderRun : Run {
    std::array<double, norm::count> error{}, order{};
    double constraint_norm = 0;
};

void compute(OrderRun& run, const StudyOptions& options)
{
    ReferenceErrors comparison(*run.c, run.h);
    lie::Observer* observers[] = {&comparison};
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-13);  // error of F_N: Newton error times m/h²
    march(run, settings, observers);
    run.error = comparison.error;
    run.constraint_norm = comparison.constraint_norm;
    if (run.failed()) run.error.fill(std::nan(""));
}

using OrderSeries = std::vector<const OrderRun*>;

double fit(const OrderSeries& series, int n)
{
    std::vector<double> h, e;
    for (const OrderRun* run : series)
        if (!run->failed() && run->error[n] > rounding) h.push_back(run->h), e.push_back(run->error[n]);
    while (h.size() > 2 && h.front() > largest_fitted_step * (1 + 1e-9))
        h.erase(h.begin()), e.erase(e.begin());
    return fitted_order(h, e);
}

void print(const OrderSeries& series, std::ostream& out)
{
    const OrderRun& first = *series.front();
    out << fmt::format("\n{}, {}; reference solution: {}\n", first.c->problem.name, first.scheme->name,
                       first.c->reference_name);
    std::vector<Table::Column> columns = {{"h [s]", "{:.2e}"}};
    for (const char* head : {"r [m]", "A", "alpha [m]", "F_N [N]"}) {
        columns.push_back({head, "{:.3e}"});
        columns.push_back({"order", "{:.2f}"});
    }
    columns.insert(columns.end(), {{"iter", "{:.2f}"}, {"|Phi|", "{:.1e}"}, {"status"}});
    Table table(columns);
    for (const OrderRun* run : series) {
        std::vector<Table::Cell> row = {run->h};
        for (int n = 0; n < norm::count; ++n) row.insert(row.end(), {run->error[n], run->order[n]});
        row.insert(row.end(), {run->statistics.iterations_per_step(), run->constraint_norm, run->status});
        table.add(row);
    }
    table.print(out);
}

void print_fits(const std::vector<OrderSeries>& all, std::ostream& out)
{
    Table table({{"problem"},
                 {"integrator"},
                 {"r", "{:.2f}"},
                 {"A", "{:.2f}"},
                 {"alpha", "{:.2f}"},
                 {"F_N", "{:.2f}"}});
    for (const OrderSeries& series : all) {
        std::vector<Table::Cell> row = {series.front()->c->problem.name, series.front()->scheme->name};
        for (int n = 0; n < norm::count; ++n) row.emplace_back(fit(series, n));
        table.add(row);
    }
    out << "\nfitted orders, steps up to 5e-3 s\n";
    table.print(out);
}

Table as_table(const std::vector<OrderRun>& runs)
{
    std::vector<Table::Column> columns = {{"problem"}, {"integrator"}, {"h"}};
    for (const char* name : norm::names) columns.push_back({std::string("error_") + name});
    for (const char* name : norm::names) columns.push_back({std::string("order_") + name});
    for (const char* name : {"steps", "iterations_per_step", "constraint_norm", "cpu_seconds", "status"})
        columns.push_back({name});
    Table table(columns);
    for (const OrderRun& run : runs) {
        std::vector<Table::Cell> row = {run.c->problem.name, run.scheme->name, run.h};
        for (const double e : run.error) row.emplace_back(e);
        for (const double p : run.order) row.emplace_back(p);
        row.insert(row.end(),
                   {static_cast<double>(run.statistics.steps), run.statistics.iterations_per_step(),
                    run.constraint_norm, run.seconds, run.status});
        table.add(row);
    }
    return table;
}

io::Json as_json(const std::vector<OrderSeries>& all)
{
    io::Json out = io::Json::array();
    for (const OrderSeries& series : all) {
        const OrderRun& first = *series.front();
        io::Json fits = io::Json::object(), rows = io::Json::array();
        for (int n = 0; n < norm::count; ++n) fits[norm::names[n]] = fit(series, n);
        for (const OrderRun* run : series) {
            io::Json row = {{"h", run->h}, {"status", run->status}};
            for (int n = 0; n < norm::count; ++n) row[norm::names[n]] = run->error[n];
            rows.push_back(row);
        }
        out.push_back({{"problem", first.c->problem.name},
                       {"integrator", first.scheme->name},
                       {"reference", first.c->reference_name},
                       {"fitted_order", fits},
                       {"rows", rows}});
    }
    return out;
}

/// Acceptance criteria: the declared orders
std::vector<Criterion> criteria(const std::vector<OrderSeries>& all)
{
    std::vector<Criterion> checks;
    for (const OrderSeries& series : all) {
        const lie::Scheme& scheme = *series.front()->scheme;
        const bool ball = series.front()->c->problem.name.find("ball") != std::string::npos;
        for (const int n : {norm::r, norm::alpha, norm::F_N}) {
            const double order = n == norm::F_N ? scheme.order_lambda : scheme.order;
            checks.push_back(criterion(fmt::format("order of {}, {} by {}", norm::names[n],
                                                   series.front()->c->problem.name, scheme.name),
                                       fit(series, n), order, ball ? 0.03 : 0.05));
        }
    }
    return checks;
}

std::vector<std::string> keys()
{
    std::vector<std::string> all = {"order"};
    for (const char* name : norm::names) all.insert(all.end(), {name, std::string("order_") + name});
    return all;
}

Measured measured(const OrderSeries& series)
{
    Measured m{.of = series.front()->scheme->name + " on " + series.front()->c->problem.name, .value = {}};
    for (int n = 0; n < norm::count; ++n) {
        m.value[std::string("order_") + norm::names[n]] = fit(series, n);
        m.value[norm::names[n]] = series.back()->error[n];
    }
    m.value["order"] = fit(series, norm::r);
    return m;
}

/// The benchmarks, with the normal rows of --normal-rows
std::vector<Benchmark> selected_benchmarks(const StudyOptions& options)
{
    std::vector<Benchmark> all;
    const std::vector<std::string> otherwise = {"ball_in_bowl", "ball_in_bowl_xy", "rolling_ball_in_bowl",
                                                "rolling_ball_in_bowl_xy", "wobbling_ellipsoid"};
    for (const std::string& name : options.problems.empty() ? otherwise : options.problems) {
        Problem p = problem_or_file(name);
        if (!options.normal_rows.empty())
            p.model =
                dae::read_model(p.model, p.name, normal_rows(name, options.set, options.normal_rows)).text;
        all.push_back(make_benchmark(std::move(p), options));
        if (evolving_contacts(*all.back().started->model).empty())
            throw io::UsageError("study " + kind + ": " + name +
                                 " has no evolving contact, which this study needs");
    }
    return all;
}

int study(const StudyOptions& options)
{
    check_keys(kind, options, keys());
    const std::vector<double> steps = steps_or(options, {1e-2, 5e-3, 2.5e-3, 1.25e-3});
    const Schemes schemes =
        fixed_step_schemes(kind, options, {"rA-half-1", "rA-half-1-kick", "rA-half-1-momentum"});
    Evaluated evaluated{.smallest_step = steps.back()};
    for (const lie::Scheme* s : schemes)
        evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    std::vector<Benchmark> benchmarks = selected_benchmarks(options);
    for (const Benchmark& c : benchmarks) check_steps(kind, c, steps, c.instants.dt * c.instants.stride);
    reference.evaluate(benchmarks);

    std::vector<OrderRun> runs;
    for (const Benchmark& c : benchmarks)
        for (const lie::Scheme* s : schemes)
            for (const double h : steps) {
                OrderRun run;
                run.c = &c, run.scheme = s, run.h = h;
                run.order.fill(std::nan(""));
                runs.push_back(run);
            }
    std::vector<long> queue(runs.size());  // small steps first: they take the longest time
    std::iota(queue.begin(), queue.end(), 0);
    std::stable_sort(queue.begin(), queue.end(), [&](long a, long b) { return runs[a].h < runs[b].h; });
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[queue[k]], options);
    });

    std::vector<OrderSeries> all;
    for (size_t k = 0; k < runs.size(); ++k) {
        if (k % steps.size() == 0) all.emplace_back();
        if (k % steps.size() != 0)
            for (int n = 0; n < norm::count; ++n)
                runs[k].order[n] = order(runs[k - 1].h, runs[k - 1].error[n], runs[k].h, runs[k].error[n]);
        all.back().push_back(&runs[k]);
    }

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"series", as_json(all)}}};
    for (const OrderSeries& series : all) print(series, output.text);
    print_fits(all, output.text);
    for (const Benchmark& c : benchmarks) output.figures.push_back(kind + '-' + c.problem.name + ".png");
    std::vector<Measured> measurements;
    for (const OrderSeries& series : all) measurements.push_back(measured(series));
    const bool passed = !options.check || evaluate(criteria(all), output.text, output.json);
    const int code = finish(options, output, run_pointers(runs), measurements);
    return code == io::exit_code::done && !passed ? io::exit_code::expectation_failed : code;
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "order of convergence of the schemes for evolving contacts (Ch. 5)",
                         .accepted = takes::reference | takes::check | takes::normal_rows,
                         .run = study});

}  // namespace

}  // namespace hilda::studies
