// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of the half-implicit schemes on contacts that are constraints (Fang 2022, Ch. 5).
///
/// rA-half-1 is the text: its start takes v_0 for v_{-1/2}, and its gyroscopic torque is late by half a step; on a ball,
/// which has none, the start alone makes it first order. rA-half-1-kick starts with half a kick and extrapolates
/// velocities to the node. rA-half-1-momentum balances angular momentum and needs no gyroscopic torque. Each is judged by
/// the largest error of position, orientation, contact points and normal force over the instants of the truth. --check
/// demands the orders.

#include "studies/exit_codes.hpp"
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

using nlohmann::ordered_json;
namespace norm = evolving_norm;

const std::string kind = "evolving-order";
constexpr double asymptotic_step = 5e-3;  // a line is fitted through steps up to this [s]
constexpr double rounding = 1e-9;  // errors below it say nothing of the order: F_N has a noise of ε m/h²

struct OrderRun : Run {
    std::array<double, norm::count> error{}, order{};
    double constraint_norm = 0;
};

void compute(OrderRun& run, const StudyOptions& options)
{
    ReferenceErrors against(*run.c, run.h);
    lie::Observer* observers[] = {&against};
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-13);  // forces are judged: lengths times m/h²
    march(run, settings, observers);
    run.error = against.error;
    run.constraint_norm = against.constraint_norm;
    if (run.failed()) run.error.fill(std::nan(""));
}

using Series = std::vector<const OrderRun*>;

double fit(const Series& series, int n)
{
    std::vector<double> h, e;
    for (const OrderRun* run : series)
        if (!run->failed() && run->error[n] > rounding) h.push_back(run->h), e.push_back(run->error[n]);
    while (h.size() > 2 && h.front() > asymptotic_step * (1 + 1e-9)) h.erase(h.begin()), e.erase(e.begin());
    return fitted_order(h, e);
}

void print(const Series& series, std::ostream& out)
{
    const OrderRun& first = *series.front();
    out << fmt::format("\n{}, {}; truth: {}\n", first.c->problem.name, first.scheme->name,
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

void print_fits(const std::vector<Series>& all, std::ostream& out)
{
    Table table({{"problem"},
                 {"integrator"},
                 {"r", "{:.2f}"},
                 {"A", "{:.2f}"},
                 {"alpha", "{:.2f}"},
                 {"F_N", "{:.2f}"}});
    for (const Series& series : all) {
        std::vector<Table::Cell> row = {series.front()->c->problem.name, series.front()->scheme->name};
        for (int n = 0; n < norm::count; ++n) row.emplace_back(fit(series, n));
        table.add(row);
    }
    out << "\nfitted orders, through steps up to 5e-3 s\n";
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

ordered_json as_json(const std::vector<Series>& all)
{
    ordered_json out = ordered_json::array();
    for (const Series& series : all) {
        const OrderRun& first = *series.front();
        ordered_json fits = ordered_json::object(), rows = ordered_json::array();
        for (int n = 0; n < norm::count; ++n) fits[norm::names[n]] = number_or_null(fit(series, n));
        for (const OrderRun* run : series) {
            ordered_json row = {{"h", run->h}, {"status", run->status}};
            for (int n = 0; n < norm::count; ++n) row[norm::names[n]] = number_or_null(run->error[n]);
            rows.push_back(row);
        }
        out.push_back({{"problem", first.c->problem.name},
                       {"integrator", first.scheme->name},
                       {"truth", first.c->reference_name},
                       {"fitted_order", fits},
                       {"rows", rows}});
    }
    return out;
}

/// What must come out
std::vector<Criterion> criteria(const std::vector<Series>& all)
{
    std::vector<Criterion> must;
    for (const Series& series : all) {
        const lie::Scheme& scheme = *series.front()->scheme;
        const bool ball = series.front()->c->problem.name.find("ball") != std::string::npos;
        for (const int n : {norm::r, norm::alpha, norm::F_N}) {
            const double order = n == norm::F_N ? scheme.order_lambda : scheme.order;
            must.push_back(criterion(fmt::format("order of {}, {} by {}", norm::names[n],
                                                 series.front()->c->problem.name, scheme.name),
                                     fit(series, n), order, ball ? 0.03 : 0.05));
        }
    }
    return must;
}

std::vector<std::string> keys()
{
    std::vector<std::string> all = {"order"};
    for (const char* name : norm::names) all.insert(all.end(), {name, std::string("order_") + name});
    return all;
}

Measured measured(const Series& series)
{
    Measured m{.of = series.front()->scheme->name + " on " + series.front()->c->problem.name, .value = {}};
    for (int n = 0; n < norm::count; ++n) {
        m.value[std::string("order_") + norm::names[n]] = fit(series, n);
        m.value[norm::names[n]] = series.back()->error[n];
    }
    m.value["order"] = fit(series, norm::r);
    return m;
}

/// The cases, each with the rows for the normals that were asked for
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
            throw UsageError("study " + kind + ": " + name + " has no contact that is a constraint");
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
    std::vector<long> queue(runs.size());  // small steps first: they take longest
    std::iota(queue.begin(), queue.end(), 0);
    std::stable_sort(queue.begin(), queue.end(), [&](long a, long b) { return runs[a].h < runs[b].h; });
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[queue[k]], options);
    });

    std::vector<Series> all;
    for (size_t k = 0; k < runs.size(); ++k) {
        if (k % steps.size() == 0) all.emplace_back();
        if (k % steps.size() != 0)
            for (int n = 0; n < norm::count; ++n)
                runs[k].order[n] = order(runs[k - 1].h, runs[k - 1].error[n], runs[k].h, runs[k].error[n]);
        all.back().push_back(&runs[k]);
    }

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"series", as_json(all)}}};
    for (const Series& series : all) print(series, output.text);
    print_fits(all, output.text);
    for (const Benchmark& c : benchmarks) output.figures.push_back(kind + '-' + c.problem.name + ".png");
    std::vector<Measured> came;
    for (const Series& series : all) came.push_back(measured(series));
    const bool passed = !options.check || evaluate(criteria(all), output.text, output.json);
    const int code = finish(options, output, run_pointers(runs), came);
    return code == exit_code::done && !passed ? exit_code::expectation_failed : code;
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "order of the schemes on contacts that are constraints (Fang 2022, Ch. 5)",
          .also = takes::reference | takes::check | takes::normal_rows,
          .run = study});

}  // namespace

}  // namespace hilda::studies
