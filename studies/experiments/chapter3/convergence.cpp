// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of the schemes against a trusted solution (Fang 2022, Figs. 3.4, 3.6, 3.7, 3.8).
///
/// For each problem, scheme and step: the errors of errors.hpp, the order each shows against the row before,
/// iterations and factorizations. A line is fitted through the rows that are neither at rounding nor at the
/// floor that the Newton tolerance sets: each run is repeated with a hundredth of the tolerance, and an error
/// that this changes is not the scheme's own.

#include "studies/experiments/chapter3/convergence.hpp"

#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/running/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace hilda::studies {

namespace {

using nlohmann::ordered_json;

const std::string kind = "convergence";
constexpr double rounding = 2e-12;  // of the size of a quantity: what a truth computed to 1e-13 is good for
constexpr double floor_change =
    0.05;  // an error that changes by more with a tighter tolerance is at its floor
constexpr double asymptotic_step = 1e-3;  // a line is fitted through steps up to this [s]

struct ConvergenceRun : EvaluatedRun {
    std::array<bool, norm::count> at_floor{};
    std::array<double, norm::count> order{};
};

void compute(ConvergenceRun& run, const StudyOptions& options)
{
    evaluate(run, options.settings);
    if (run.failed()) return;
    ConvergenceRun tighter = run;
    lie::Settings settings = options.settings;
    settings.tolerance /= 100;
    evaluate(tighter, settings);
    if (tighter.failed()) return;  // below rounding already; no floor to see
    for (int n = 0; n < norm::count; ++n) {
        const double e = run.errors.value[n], e_tighter = tighter.errors.value[n];
        run.at_floor[n] = !(e > rounding * std::max(run.c->size.value[n], 1e-3)) ||
                          std::abs(e - e_tighter) > floor_change * e;
    }
}

/// The rows of one scheme on one problem, from the largest step down
using Series = std::vector<const ConvergenceRun*>;

/// Slope through the clean rows with steps up to asymptotic_step; where there are fewer than three of these, as
/// of a scheme of high order, which is at rounding there, through the three smallest.
double fit(const Series& series, int n)
{
    std::vector<double> h, e;
    size_t asymptotic = 0;
    for (const ConvergenceRun* run : series) {
        if (run->failed() || run->at_floor[n]) continue;
        h.push_back(run->h), e.push_back(run->errors.value[n]);
        asymptotic += run->h <= asymptotic_step * (1 + 1e-9);
    }
    const size_t left_out = h.size() - std::min(h.size(), std::max<size_t>(3, asymptotic));
    h.erase(h.begin(), h.begin() + static_cast<std::ptrdiff_t>(left_out));
    e.erase(e.begin(), e.begin() + static_cast<std::ptrdiff_t>(left_out));
    return fitted_order(h, e);
}

void print(const Series& series, std::ostream& out)
{
    const ConvergenceRun& first = *series.front();
    out << fmt::format("\n{}, {} (declared order {}, of lambda {}); truth: {}\n", first.c->problem.name,
                       first.scheme->name, first.scheme->order, first.scheme->order_lambda,
                       first.c->reference_name);
    std::vector<Table::Column> columns = {{"h [s]", "{:.1e}"}};
    const char* heads[] = {"r [m]", "A", "v [m/s]", "omega [rad/s]", "Q"};
    for (int n = norm::r; n <= norm::Q; ++n) {
        columns.push_back({heads[n], "{}"});
        columns.push_back({"order", "{:.2f}"});
    }
    columns.insert(columns.end(), {{"iter", "{:.2f}"}, {"|Phi|", "{:.1e}"}, {"|A'A-I|", "{:.1e}"}});
    Table table(columns);
    for (const ConvergenceRun* run : series) {
        std::vector<Table::Cell> row = {run->h};
        for (int n = norm::r; n <= norm::Q; ++n) {
            const double e = run->errors.value[n];
            row.emplace_back(std::isnan(e) ? run->status
                                           : fmt::format("{:.3e}{}", e, run->at_floor[n] ? "*" : " "));
            row.emplace_back(run->order[n]);
        }
        row.emplace_back(run->statistics.iterations_per_step());
        row.emplace_back(run->constraint_norm);
        row.emplace_back(run->orthogonality);
        table.add(row);
    }
    std::vector<Table::Cell> fits = {std::string("fit")};
    for (int n = norm::r; n <= norm::Q; ++n) {
        fits.emplace_back(std::string());
        fits.emplace_back(fit(series, n));
    }
    fits.resize(columns.size(), std::string());
    table.add(fits);
    table.print(out);
}

/// Fitted orders of all schemes on one problem, side by side
void print_fits(const std::vector<Series>& all, const Benchmark& c, std::ostream& out)
{
    Table table({{c.problem.name},
                 {"declared"},
                 {"r", "{:.2f}"},
                 {"A", "{:.2f}"},
                 {"v", "{:.2f}"},
                 {"omega", "{:.2f}"},
                 {"Q", "{:.2f}"},
                 {"r [m] at " + step_text(all.front().back()->h) + " s"},
                 {"status"}});
    for (const Series& series : all) {
        const ConvergenceRun& first = *series.front();
        if (first.c != &c) continue;
        std::vector<Table::Cell> row = {
            first.scheme->name, fmt::format("{}, {}", first.scheme->order, first.scheme->order_lambda)};
        for (int n = norm::r; n <= norm::Q; ++n) row.emplace_back(fit(series, n));
        row.emplace_back(series.back()->errors.value[norm::r]);
        const auto failed =
            std::find_if(series.begin(), series.end(), [](const ConvergenceRun* r) { return r->failed(); });
        row.emplace_back(failed == series.end() ? "ok"
                                                : (*failed)->status + " at " + step_text((*failed)->h));
        table.add(row);
    }
    out << '\n';
    table.print(out);
}

Table as_table(const std::vector<ConvergenceRun>& runs)
{
    std::vector<Table::Column> columns = {
        {"problem"}, {"integrator"}, {"h"}, {"instants"}, {"watched_scalar"}};
    for (const char* name : norm::names) columns.push_back({name});
    for (const char* name : norm::names) columns.push_back({std::string("order_") + name});
    for (const char* name : norm::names) columns.push_back({std::string("floor_") + name});
    for (const char* name : {"steps", "iterations_per_step", "factorizations", "refactorizations",
                             "constraint_norm", "orthogonality", "cpu_seconds", "status"})
        columns.push_back({name});
    Table table(columns);
    for (const ConvergenceRun& run : runs) {
        std::vector<Table::Cell> row = {run.c->problem.name, run.scheme->name, run.h,
                                        static_cast<double>(run.errors.instants), run.c->observable.name()};
        for (const double e : run.errors.value) row.emplace_back(e);
        for (const double p : run.order) row.emplace_back(p);
        for (const bool f : run.at_floor) row.emplace_back(f ? 1.0 : 0.0);
        row.emplace_back(static_cast<double>(run.statistics.steps));
        row.emplace_back(run.statistics.iterations_per_step());
        row.emplace_back(static_cast<double>(run.statistics.factorizations));
        row.emplace_back(static_cast<double>(run.statistics.refactorizations));
        row.emplace_back(run.constraint_norm);
        row.emplace_back(run.orthogonality);
        row.emplace_back(run.seconds);
        row.emplace_back(run.status);
        table.add(row);
    }
    return table;
}

ordered_json as_json(const std::vector<Series>& all)
{
    ordered_json out = ordered_json::array();
    for (const Series& series : all) {
        const ConvergenceRun& first = *series.front();
        ordered_json fits = ordered_json::object(), rows = ordered_json::array();
        for (int n = 0; n < norm::count; ++n) fits[norm::names[n]] = number_or_null(fit(series, n));
        for (const ConvergenceRun* run : series) {
            ordered_json row = {{"h", run->h}, {"status", run->status}};
            if (!run->message.empty()) row["message"] = run->message;
            for (int n = 0; n < norm::count; ++n) row[norm::names[n]] = number_or_null(run->errors.value[n]);
            row["iterations_per_step"] = run->statistics.iterations_per_step();
            row["factorizations"] = run->statistics.factorizations;
            row["cpu_seconds"] = run->seconds;
            rows.push_back(row);
        }
        out.push_back({{"problem", first.c->problem.name},
                       {"integrator", first.scheme->name},
                       {"declared_order", first.scheme->order},
                       {"declared_order_lambda", first.scheme->order_lambda},
                       {"truth", first.c->reference_name},
                       {"watched", first.c->observable.name()},
                       {"fitted_order", fits},
                       {"rows", rows}});
    }
    return out;
}

/// What --expect knows: order (of the first quantity whose order shows), order_X, and X at the smallest step
std::vector<std::string> keys()
{
    std::vector<std::string> all = {"order"};
    for (const char* name : norm::names) all.push_back(std::string("order_") + name);
    all.insert(all.end(), norm::names.begin(), norm::names.end());
    return all;
}

Measured measured(const Series& series)
{
    Measured m{.of = series.front()->scheme->name + " on " + series.front()->c->problem.name, .value = {}};
    m.value["order"] = std::nan("");
    for (int n = norm::count; n-- > 0;) {
        const double order = fit(series, n);
        m.value[std::string("order_") + norm::names[n]] = order;
        m.value[norm::names[n]] = series.back()->errors.value[n];
        if (!std::isnan(order)) m.value["order"] = order;
    }
    return m;
}

std::vector<double> default_steps() { return {1e-2, 4e-3, 2e-3, 1e-3, 8e-4, 4e-4, 2e-4, 1e-4}; }

std::vector<std::string> default_problems()
{
    return {"double_pendulum", "double_pendulum_moving", "n_pendulum_2_spin", "slider_crank", "four_link"};
}

}  // namespace

int convergence(const StudyOptions& options)
{
    check_keys(kind, options, keys());
    const std::vector<double> steps = steps_or(options, default_steps());
    const Schemes schemes = fixed_step_schemes(kind, options);
    Evaluated evaluated{.smallest_step = steps.back()};
    for (const lie::Scheme* s : schemes)
        evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    std::vector<Benchmark> all_cases = benchmarks(kind, options, default_problems());
    for (const Benchmark& c : all_cases) check_steps(kind, c, steps, c.instants.dt * c.instants.stride);
    reference.evaluate(all_cases);

    std::vector<ConvergenceRun> runs;
    for (const Benchmark& c : all_cases)
        for (const lie::Scheme* s : schemes)
            for (const double h : steps) {
                ConvergenceRun run;
                run.c = &c, run.scheme = s, run.h = h;
                run.order.fill(std::nan(""));
                runs.push_back(run);
            }

    // Small steps first: they take longest, and the last job to end decides when all have.
    std::vector<long> queue(runs.size());
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
                runs[k].order[n] =
                    order(runs[k - 1].h, runs[k - 1].errors.value[n], runs[k].h, runs[k].errors.value[n]);
        all.back().push_back(&runs[k]);
    }

    StudyOutput output{.kind = kind, .table = as_table(runs).csv(), .json = {{"series", as_json(all)}}};
    for (const Series& series : all) print(series, output.text);
    output.text
        << "\n* at rounding, or at the floor that the Newton tolerance sets: not in the fit, which takes "
           "steps up to 1e-3 s, or the three smallest\n\nfitted orders; declared: of the motion, of lambda\n";
    for (const Benchmark& c : all_cases) print_fits(all, c, output.text);
    for (const Benchmark& c : all_cases) output.figures.push_back("convergence-" + c.problem.name + ".png");
    std::vector<Measured> came;
    for (const Series& series : all) came.push_back(measured(series));
    return finish(options, output, run_pointers(runs), came);
}

namespace {

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "order of the schemes against a trusted solution (Figs. 3.4, 3.6, 3.7, 3.8)",
          .also = takes::reference,
          .run = convergence});

}  // namespace

}  // namespace hilda::studies
