// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of convergence of the schemes (Fang 2022, Figs. 3.4, 3.6, 3.7, 3.8).
///
/// For each problem, scheme and step the study computes the errors of errors.hpp against a reference
/// solution, the order between neighbouring steps, the Newton iterations and the factorizations. The order of
/// a scheme is the slope of a least-squares line through log(error) over log(h). Errors at the floor are left
/// out of this line, and not printed: their digits are those of rounding errors. An error is at the floor if
/// it is
///
/// - less than 10 times the estimated error of the reference solution, see Reference::estimate_errors,
/// - less than 20 times the difference to a second run with a hundredth of the Newton tolerance and the other
///   linear solver, which has other rounding errors and a smaller error of Newton's method,
/// - or at rounding level.
///
/// Without --all, --problem, --integrator and --steps the study is a subset: the schemes of the dissertation
/// and their second-order relatives on two mechanisms, with a short table and two figures.

#include "dae/model_file.hpp"
#include "lie/solver/saddle.hpp"
#include "run/diagnosis.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/convergence_study.hpp"
#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace hilda::studies {

namespace {

// Rounding level of an error, relative to the size of the quantity; reference solutions are accurate to 1e-13
constexpr double rounding = 2e-12;
// An error must exceed the estimated error of the reference solution, and that of the run, by these factors.
// The error of the run by Newton's method adds to the error that is measured: 5 % of it change the order of a
// pair by 0.07.
constexpr double margin_of_reference = 10, margin_of_run = 20;

const ConvergenceStudy study{.norms = {norm::names.begin(), norm::names.end()},
                             .asymptotic_step = 1e-3,
                             .least_points = 3,
                             .prefix_of_errors = ""};

/// The same run with other errors of Newton's method and other rounding errors; nullopt if it fails. A
/// hundredth of the Newton tolerance may be below rounding; then a tenth is used, or ten times the tolerance.
std::optional<EvaluatedRun> second_run(const Run& run, const lie::Settings& of_study)
{
    lie::Settings settings = of_study;
    const lie::Saddle first(*run.c->started->model, lie::Metric::mass, of_study.linear_solver);
    settings.linear_solver = first.is_condensed() ? lie::LinearSolver::klu : lie::LinearSolver::condensed;
    for (const double factor : {0.01, 0.1, 10.}) {
        settings.tolerance = factor * of_study.tolerance;
        EvaluatedRun second{run};
        evaluate(second, settings);
        if (!second.failed()) return second;
    }
    return std::nullopt;
}

/// Integrates twice; errors and floor flags into `run`.
void compute(ErrorRun& run, const lie::Settings& settings)
{
    Run& common = run;  // the part that ErrorRun and EvaluatedRun have in common
    EvaluatedRun with_tolerance{common};
    evaluate(with_tolerance, settings);
    common = static_cast<const Run&>(with_tolerance);
    run.error.assign(with_tolerance.errors.value.begin(), with_tolerance.errors.value.end());
    run.constraint_norm = with_tolerance.constraint_norm;
    run.orthogonality = with_tolerance.orthogonality;
    run.instants = with_tolerance.errors.instants;
    if (run.failed()) return;
    Errors of_run;
    if (const std::optional<EvaluatedRun> second = second_run(common, settings))
        of_run = difference(with_tolerance, *second);
    for (int n = 0; n < norm::count; ++n) {
        const double floor =
            std::max({margin_of_reference * run.c->uncertainty.value[n], margin_of_run * of_run.value[n],
                      rounding * std::max(run.c->size.value[n], 1e-3)});
        run.at_floor[n] = !(run.error[n] > floor);
    }
}

/// The error in norm n; a * if it is at the floor; the status of a run that failed
std::string error_text(const ErrorRun& run, int n, int decimals)
{
    if (run.failed()) return run.status;
    return run.at_floor[n] != 0 ? "*" : fmt::format("{:.{}e}", run.error[n], decimals);
}

/// A residual that should be zero. At rounding level its digits are not printed.
std::string residual_text(double value)
{
    constexpr double rounding_level = 1e-12;
    return value < rounding_level ? "<1e-12" : fmt::format("{:.1e}", value);
}

/// All steps of one scheme on one problem
void print(const Series& series, StudyText& out)
{
    const ErrorRun& first = *series.front();
    out << fmt::format("\n{}, {} (declared order {}, of lambda {}); reference solution: {}\n",
                       first.c->problem.name, first.scheme->name, first.scheme->order,
                       first.scheme->order_lambda, first.c->reference_name);
    std::vector<Table::Column> columns = {{"h [s]", "{:.1e}"}};
    const char* heads[] = {"r [m]", "A", "v [m/s]", "omega [rad/s]", "Q"};
    for (int n = norm::r; n <= norm::Q; ++n) {
        columns.push_back({heads[n], "{}"});
        columns.push_back({"order", "{:.2f}"});
    }
    columns.insert(columns.end(), {{"iter", "{:.2f}"}, {"|Phi|"}, {"|A'A-I|"}});
    Table table(columns);
    for (const ErrorRun* run : series) {
        std::vector<Table::Cell> row = {run->h};
        for (int n = norm::r; n <= norm::Q; ++n) {
            row.emplace_back(error_text(*run, n, 3));
            row.emplace_back(run->order[n]);
        }
        row.emplace_back(run->statistics.iterations_per_step());
        row.emplace_back(residual_text(run->constraint_norm));
        row.emplace_back(residual_text(run->orthogonality));
        table.add(row);
    }
    std::vector<Table::Cell> fits = {std::string("fit")};
    for (int n = norm::r; n <= norm::Q; ++n) {
        fits.emplace_back(std::string());
        fits.emplace_back(study.fit(series, n));
    }
    fits.resize(columns.size(), std::string());
    table.add(fits);
    table.print(out);
}

/// Fitted orders of all schemes on one problem
void print_fits(const std::vector<Series>& all, const Benchmark& c, StudyText& out)
{
    Table table({{c.problem.name},
                 {"declared"},
                 {"r", "{:.2f}"},
                 {"A", "{:.2f}"},
                 {"v", "{:.2f}"},
                 {"omega", "{:.2f}"},
                 {"Q", "{:.2f}"},
                 {"r [m] at " + run::step_text(all.front().back()->h) + " s"},
                 {"status"}});
    for (const Series& series : all) {
        const ErrorRun& first = *series.front();
        if (first.c != &c) continue;
        std::vector<Table::Cell> row = {
            first.scheme->name, fmt::format("{}, {}", first.scheme->order, first.scheme->order_lambda)};
        for (int n = norm::r; n <= norm::Q; ++n) row.emplace_back(study.fit(series, n));
        row.emplace_back(error_text(*series.back(), norm::r, 3));
        const auto failed =
            std::find_if(series.begin(), series.end(), [](const ErrorRun* r) { return r->failed(); });
        row.emplace_back(failed == series.end() ? "ok"
                                                : (*failed)->status + " at " + run::step_text((*failed)->h));
        table.add(row);
    }
    out << '\n';
    table.print(out);
}

/// The table of the default selection: orders, and errors at two steps, of position and constraint loads
void print_overview(const std::vector<Series>& all, const std::vector<Benchmark>& problems, StudyText& out)
{
    const auto at = [](const Series& series, double h) {
        return *std::find_if(series.begin(), series.end(),
                             [h](const ErrorRun* run) { return run->h <= h * (1 + 1e-9); });
    };
    const double large = study.asymptotic_step, small = all.front().back()->h;
    out << fmt::format(
        "r: position error, rms over {0} instants [m]. Q: relative error of constraint loads, rms.\n"
        "order: slope of log(error) over log(h), h <= {1} s. iter: Newton iterations per step, h={1} s.\n",
        problems.front().instants.count / problems.front().instants.stride, run::step_text(large));
    bool floor = false;
    for (const Benchmark& c : problems) {
        out << fmt::format("\n{}, {} s; reference solution: {}\n", c.problem.name, c.end, c.reference_name);
        Table table({{"integrator"},
                     {"order of r", "{:.2f}"},
                     {"r, h=" + run::step_text(large)},
                     {"r, h=" + run::step_text(small)},
                     {"order of Q", "{:.2f}"},
                     {"Q, h=" + run::step_text(large)},
                     {"Q, h=" + run::step_text(small)},
                     {"iter", "{:.2f}"}});
        for (const Series& series : all) {
            if (series.front()->c != &c) continue;
            std::vector<Table::Cell> row = {series.front()->scheme->name};
            for (const int n : {norm::r, norm::Q}) {
                row.emplace_back(study.fit(series, n));
                for (const double h : {large, small}) row.emplace_back(error_text(*at(series, h), n, 1));
                floor = floor || at(series, large)->at_floor[n] != 0 || at(series, small)->at_floor[n] != 0;
            }
            row.emplace_back(at(series, large)->statistics.iterations_per_step());
            table.add(row);
        }
        table.print(out);
    }
    if (floor)
        out << "\n* at rounding, or near the error of Newton's method or of the reference: not used for the "
               "order\n";
}

/// The fitted order of each scheme, of the first quantity that has one, is the declared one within 15 %.
std::vector<Criterion> criteria_of_orders(const std::vector<Series>& all)
{
    std::vector<Criterion> checks;
    for (const Series& series : all) {
        const Measured m = study.measured(series);
        const int declared = series.front()->scheme->order;
        checks.push_back(criterion("order of " + m.of, m.value.at("order"), declared, 0.15 * declared));
    }
    return checks;
}

/// Series whose fitted order is below the declared one by more than a half, and problems whose errors are
/// near that of the reference solution for all schemes and steps
void add_findings(const std::vector<Series>& all, const std::vector<Benchmark>& problems, StudyContext& s)
{
    constexpr double lower = 0.5;
    std::vector<std::string> findings;
    for (const Series& series : all) {
        const ErrorRun& first = *series.front();
        for (int n = norm::r; n <= norm::Q; ++n) {
            const int declared = n == norm::Q ? first.scheme->order_lambda : first.scheme->order;
            const double order = study.fit(series, static_cast<size_t>(n));
            if (!(order < declared - lower)) continue;
            findings.push_back(fmt::format("{} on {}: the order of {} is {:.2f}, and {} is declared",
                                           first.scheme->name, first.c->problem.name,
                                           norm::names[static_cast<size_t>(n)], order, declared));
            s.warned("order_below_declared", findings.back());
            break;
        }
    }
    for (const Benchmark& c : problems) {
        const auto is_at_floor = [&](const Series& series) {
            return series.front()->c != &c ||
                   std::all_of(series.begin(), series.end(), [](const ErrorRun* run) {
                       return run->failed() || run->at_floor[norm::r] != 0;
                   });
        };
        const auto is_of_reference = [&](const Series& series) {
            return series.front()->c == &c &&
                   std::any_of(series.begin(), series.end(), [&](const ErrorRun* run) {
                       return !run->failed() &&
                              run->error[norm::r] <= margin_of_reference * c.uncertainty.value[norm::r];
                   });
        };
        if (!std::all_of(all.begin(), all.end(), is_at_floor) ||
            std::none_of(all.begin(), all.end(), is_of_reference))
            continue;
        findings.push_back(
            fmt::format("{}: no run has an error above ten times that of the reference solution, "
                        "{:.1e} m by {}: it does not show an order; choose another by --reference",
                        c.problem.name, c.uncertainty.value[norm::r], c.reference_name));
        s.warned("reference_too_coarse", findings.back());
    }
    if (findings.empty()) return;
    s.text << "\nfindings:\n";
    for (const std::string& finding : findings) {
        s.text << "  " << finding << '\n';
        s.json["findings"].push_back(finding);
    }
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

void convergence(StudyContext& s)
{
    const bool short_form = selection(s.options) == "default";
    const Defaults defaults = short_form ? overview() : complete();
    const std::vector<double> steps = s.steps(defaults.steps);
    const Schemes schemes = s.fixed_step_schemes(defaults.integrators);
    const Reference reference(s, finest(schemes, steps.back()));
    std::vector<Benchmark> problems = benchmarks(s.name, s.options, defaults.problems);
    reference.evaluate(problems, steps);
    reference.estimate_errors(problems);
    const Sweep<ErrorRun> runs =
        study.runs(s, problems, schemes, steps, [&](ErrorRun& run) { compute(run, s.settings); });
    const std::vector<Series> all = series_of(runs);

    const Columns<ErrorRun> columns = Columns<ErrorRun>{column::problem,
                                                        column::integrator,
                                                        column::h,
                                                        {"instants", &ErrorRun::instants},
                                                        column::observable} +
                                      study.errors() + study.orders() + study.floors() +
                                      Columns<ErrorRun>{column::steps,
                                                        column::iterations,
                                                        column::factorizations,
                                                        column::refactorizations,
                                                        {"constraint_norm", &ErrorRun::constraint_norm},
                                                        {"orthogonality", &ErrorRun::orthogonality},
                                                        column::cpu_seconds,
                                                        column::status};
    s.json["selection"] = selection(s.options);
    for (const Series& of : all) {
        const ErrorRun& first = *of.front();
        s.measured.push_back(study.measured(of));
        s.json["series"].push_back(study.json(of, columns,
                                              {"iterations_per_step", "factorizations", "cpu_seconds"},
                                              {{"declared_order", first.scheme->order},
                                               {"declared_order_lambda", first.scheme->order_lambda},
                                               {"reference", first.c->reference_name},
                                               {"observable", first.c->observable.name()}}));
    }
    s.table = columns.csv(runs);
    s.end_of_runs(run_pointers(runs));
    const auto check = [&] {
        add_findings(all, problems, s);
        if (s.check) s.evaluate(criteria_of_orders(all));
    };
    if (short_form) {
        print_overview(all, problems, s.text);
        s.figures = {"convergence-position.png", "convergence-loads.png"};
        check();
        return;
    }
    for (const Series& of : all) print(of, s.text);
    s.text << "\n* at rounding, or near the error of Newton's method or of the reference: not in the fit, "
              "which uses "
              "the steps\nup to 1e-3 s, or the three smallest\n\nfitted orders; declared: of the motion, of "
              "lambda\n";
    for (const Benchmark& c : problems) {
        print_fits(all, c, s.text);
        s.figures.push_back("convergence-" + c.problem.name + ".png");
    }
    check();
}

const bool registered_convergence = io::Registry<Study>::add(
    {.name = "convergence",
     .answers = "order of convergence of the schemes against a reference solution (Figs. 3.4, 3.6, 3.7, 3.8)",
     .options = options_of_models({"--reference", "--all", "--check", "--strict", "--shard"}),
     .keys = study.keys(),
     .files = {"convergence-position.png", "convergence-loads.png", "convergence-PROBLEM.png"},
     .run = convergence});

}  // namespace

}  // namespace hilda::studies
