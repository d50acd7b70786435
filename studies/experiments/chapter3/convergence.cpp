// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of convergence of the schemes (Fang 2022, Figs. 3.4, 3.6, 3.7, 3.8).
///
/// For each problem, scheme and step the study computes the errors of errors.hpp against a reference
/// solution, the order between neighbouring steps, the Newton iterations and the factorizations. The order of
/// a scheme is the slope of a least-squares line through log(error) over log(h). Errors at the floor are left
/// out of this line. An error is at the floor if it is at rounding level or if it depends on the Newton
/// tolerance. To detect the latter, each run is repeated with a hundredth of the tolerance.
///
/// Without --all, --problem, --integrator and --steps the study is a subset: the schemes of the dissertation
/// and their second-order relatives on two mechanisms, with a short table and two figures.

#include "studies/experiments/chapter3/convergence.hpp"

#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
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

const std::string kind = "convergence";
// Rounding level of an error, relative to the size of the quantity; reference solutions are accurate to 1e-13
constexpr double rounding = 2e-12;
// An error that changes by more than this fraction with a tighter Newton tolerance is at the floor.
constexpr double floor_change = 0.05;
constexpr double asymptotic_step = 1e-3;  // the order is fitted through steps up to this one [s]

struct ConvergenceRun : EvaluatedRun {
    std::array<bool, norm::count> at_floor{};  ///< the error is at rounding level or at the Newton tolerance
    std::array<double, norm::count> order{};   ///< between this step and the next larger one; NaN: unknown
};

/// Integrates with the given Newton tolerance and with a hundredth of it; errors and floor flags into `run`.
void compute(ConvergenceRun& run, const StudyOptions& options)
{
    evaluate(run, options.settings);
    if (run.failed()) return;
    ConvergenceRun tighter = run;
    lie::Settings settings = options.settings;
    settings.tolerance /= 100;
    evaluate(tighter, settings);
    if (tighter.failed()) return;  // the tighter tolerance is below rounding: no error is marked
    for (int n = 0; n < norm::count; ++n) {
        const double e = run.errors.value[n], e_tighter = tighter.errors.value[n];
        run.at_floor[n] = !(e > rounding * std::max(run.c->size.value[n], 1e-3)) ||
                          std::abs(e - e_tighter) > floor_change * e;
    }
}

/// The runs of one scheme on one problem, in descending order of the step
using Series = std::vector<const ConvergenceRun*>;

/// Order of convergence in norm n: the slope fitted through the errors above the floor with steps up to
/// asymptotic_step. If there are fewer than three of these, the three smallest steps above the floor are
/// used. This is the case for schemes of high order, whose errors are at rounding level for small steps.
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

/// The error in norm n, with a * if it is at the floor; the status of a run that failed
std::string error_text(const ConvergenceRun& run, int n, int decimals)
{
    const double e = run.errors.value[n];
    return std::isnan(e) ? run.status : fmt::format("{:.{}e}{}", e, decimals, run.at_floor[n] ? "*" : " ");
}

/// All steps of one scheme on one problem
void print(const Series& series, std::ostream& out)
{
    const ConvergenceRun& first = *series.front();
    out << fmt::format("\n{}, {} (declared order {}, of lambda {}); reference solution: {}\n",
                       first.c->problem.name, first.scheme->name, first.scheme->order,
                       first.scheme->order_lambda, first.c->reference_name);
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
            row.emplace_back(error_text(*run, n, 3));
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

/// Fitted orders of all schemes on one problem
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

/// The table of the default selection: orders, and errors at two steps, of position and constraint loads
void print_overview(const std::vector<Series>& all, const std::vector<Benchmark>& problems, std::ostream& out)
{
    const auto at = [](const Series& series, double h) {
        return *std::find_if(series.begin(), series.end(),
                             [h](const ConvergenceRun* run) { return run->h <= h * (1 + 1e-9); });
    };
    const double large = asymptotic_step, small = all.front().back()->h;
    out << fmt::format(
        "r: position error, rms over {0} instants [m]. Q: relative error of constraint loads, rms.\n"
        "order: slope of log(error) over log(h), h <= {1} s. iter: Newton iterations per step, h={1} s.\n",
        problems.front().instants.count / problems.front().instants.stride, step_text(large));
    bool floor = false;
    for (const Benchmark& c : problems) {
        out << fmt::format("\n{}, {} s; reference solution: {}\n", c.problem.name, c.end, c.reference_name);
        Table table({{"integrator"},
                     {"order of r", "{:.2f}"},
                     {"r, h=" + step_text(large)},
                     {"r, h=" + step_text(small)},
                     {"order of Q", "{:.2f}"},
                     {"Q, h=" + step_text(large)},
                     {"Q, h=" + step_text(small)},
                     {"iter", "{:.2f}"}});
        for (const Series& series : all) {
            if (series.front()->c != &c) continue;
            std::vector<Table::Cell> row = {series.front()->scheme->name};
            for (const int n : {norm::r, norm::Q}) {
                row.emplace_back(fit(series, n));
                for (const double h : {large, small}) row.emplace_back(error_text(*at(series, h), n, 1));
                floor = floor || at(series, large)->at_floor[n] || at(series, small)->at_floor[n];
            }
            row.emplace_back(at(series, large)->statistics.iterations_per_step());
            table.add(row);
        }
        table.print(out);
    }
    if (floor)
        out << "\n* at rounding, or at the floor set by the Newton tolerance: not used for the order\n";
}

/// study.csv: one row for each run
Table as_table(const std::vector<ConvergenceRun>& runs)
{
    std::vector<Table::Column> columns = {
        {"problem"}, {"integrator"}, {"h"}, {"instants"}, {"observable_scalar"}};
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

/// The series of study.json
io::Json as_json(const std::vector<Series>& all)
{
    io::Json out = io::Json::array();
    for (const Series& series : all) {
        const ConvergenceRun& first = *series.front();
        io::Json fits = io::Json::object(), rows = io::Json::array();
        for (int n = 0; n < norm::count; ++n) fits[norm::names[n]] = fit(series, n);
        for (const ConvergenceRun* run : series) {
            io::Json row = {{"h", run->h}, {"status", run->status}};
            if (!run->message.empty()) row["message"] = run->message;
            for (int n = 0; n < norm::count; ++n) row[norm::names[n]] = run->errors.value[n];
            row["iterations_per_step"] = run->statistics.iterations_per_step();
            row["factorizations"] = run->statistics.factorizations;
            row["cpu_seconds"] = run->seconds;
            rows.push_back(row);
        }
        out.push_back({{"problem", first.c->problem.name},
                       {"integrator", first.scheme->name},
                       {"declared_order", first.scheme->order},
                       {"declared_order_lambda", first.scheme->order_lambda},
                       {"reference", first.c->reference_name},
                       {"observable", first.c->observable.name()},
                       {"fitted_order", fits},
                       {"rows", rows}});
    }
    return out;
}

/// Keys of --expect. For each norm X: order_X, the fitted order, and X, the error at the smallest step.
/// `order` is the order_X of the first norm X for which a fit exists.
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

/// The problems, integrators and steps that are not named on the command line
struct Defaults {
    std::vector<std::string> problems;
    std::vector<std::string> integrators;  ///< empty: all with a fixed step
    std::vector<double> steps;             ///< [s]
};

Defaults complete()
{
    return {.problems = {"double_pendulum", "double_pendulum_moving", "n_pendulum_2_spin", "slider_crank",
                         "four_link"},
            .integrators = {},
            .steps = {1e-2, 4e-3, 2e-3, 1e-3, 8e-4, 4e-4, 2e-4, 1e-4}};
}

/// A planar and a spatial mechanism. Both have degrees of freedom that are not driven, and both move at the
/// start: positions and constraint loads show their orders, and no first-order term vanishes as after a start
/// at rest. The steps are consecutive steps of the complete study, so that the orders between neighbouring
/// steps are the same.
Defaults overview()
{
    return {.problems = {"double_pendulum_moving", "n_pendulum_2_spin"},
            .integrators = {"rA-full-1", "rA-half-1", "rA-half-2", "rA-half-1-kick", "rA-half-1-momentum",
                            "rA-half-2-bdf2"},
            .steps = {4e-3, 2e-3, 1e-3, 8e-4, 4e-4, 2e-4, 1e-4}};
}

/// The name of the selection in study.json, from which convergence.py chooses its figures
std::string selection(const StudyOptions& options)
{
    if (!options.problems.empty() || !options.integrators.empty() || !options.steps.empty())
        return "selected";
    return options.all ? "all" : "default";
}

}  // namespace

int convergence(const StudyOptions& options)
{
    check_keys(kind, options, keys());
    const bool short_form = selection(options) == "default";
    const Defaults defaults = short_form ? overview() : complete();
    const std::vector<double> steps = steps_or(options, defaults.steps);
    const Schemes schemes = fixed_step_schemes(kind, options, defaults.integrators);
    Evaluated evaluated{.smallest_step = steps.back()};
    for (const lie::Scheme* s : schemes)
        evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    std::vector<Benchmark> problems = benchmarks(kind, options, defaults.problems);
    for (const Benchmark& c : problems) check_steps(kind, c, steps, c.instants.dt * c.instants.stride);
    reference.evaluate(problems);

    std::vector<ConvergenceRun> runs;
    for (const Benchmark& c : problems)
        for (const lie::Scheme* s : schemes)
            for (const double h : steps) {
                ConvergenceRun run;
                run.c = &c, run.scheme = s, run.h = h;
                run.order.fill(std::nan(""));
                runs.push_back(run);
            }

    // Small steps take longest. They start first, so that no long run is alone at the end.
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

    StudyOutput output{.kind = kind,
                       .table = as_table(runs).csv(),
                       .json = {{"selection", selection(options)}, {"series", as_json(all)}}};
    if (short_form) {
        print_overview(all, problems, output.text);
        output.figures = {"convergence-position.png", "convergence-loads.png"};
    } else {
        for (const Series& series : all) print(series, output.text);
        output.text
            << "\n* at rounding, or at the floor set by the Newton tolerance: not in the fit, which uses the "
               "steps up to 1e-3 s, or the three smallest\n\nfitted orders; declared: of the motion, of "
               "lambda\n";
        for (const Benchmark& c : problems) {
            print_fits(all, c, output.text);
            output.figures.push_back("convergence-" + c.problem.name + ".png");
        }
    }
    std::vector<Measured> results;
    for (const Series& series : all) results.push_back(measured(series));
    return finish(options, output, run_pointers(runs), results);
}

namespace {

const bool registered = register_study(Study{
    .kind = kind,
    .answers = "order of convergence of the schemes against a reference solution (Figs. 3.4, 3.6, 3.7, 3.8)",
    .accepted = takes::reference | takes::all,
    .run = convergence});

}  // namespace

}  // namespace hilda::studies
