// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of the schemes against a trusted solution (Fang 2022, Figs. 3.4, 3.6, 3.7, 3.8).
///
/// For each problem, scheme and step: the errors of errors.hpp, the order each shows against the row before,
/// iterations and factorizations. A line is fitted through the rows that are neither at rounding nor at the
/// floor that the Newton tolerance sets: each run is repeated with a hundredth of the tolerance, and an error
/// that this changes is not the scheme's own.

#include "studies/convergence.hpp"

#include "studies/errors.hpp"
#include "studies/exit_codes.hpp"
#include "studies/message.hpp"
#include "studies/output.hpp"
#include "studies/plot.hpp"
#include "studies/pool.hpp"
#include "studies/problem.hpp"
#include "studies/table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <ctime>
#include <iostream>

namespace hilda::studies {

namespace {

using nlohmann::ordered_json;

constexpr double rounding = 1e-12;  // of the size of a quantity: errors below are rounding
constexpr double floor_change =
    0.05;  // an error that changes by more with a tighter tolerance is at its floor
constexpr double asymptotic_step =
    1e-3;  // a line is fitted through steps up to this where there are three of them [s]

double thread_seconds()
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A problem with its truth, computed once
struct Case {
    Problem problem;
    Instants instants;
    lie::Trajectory truth;
    Errors size;
    Watched watched;
};

dae::Description ready(const Problem& problem, const StudyOptions& options)
{
    dae::Description d = dae::read_model(problem.model, problem.name, options.set);
    dae::start(d, {});
    return d;
}

/// The case without its truth; refuses steps that do not fit it, and says what the model drops.
Case checked(const Problem& problem, const std::vector<double>& steps, const StudyOptions& options)
{
    dae::Description d = dae::read_model(problem.model, problem.name, options.set);
    const dae::StartReport report = dae::start(d, {});
    if (!options.quiet) {
        for (const std::string& w : d.warnings) warning(w);
        for (const std::string& row : report.dropped)
            warning(problem.name + ": " + row +
                    ": redundant with the constraints before it, dropped from the equations");
    }
    Case c{.problem = problem, .instants = {}, .truth = {}, .size = {}, .watched = problem.watched};
    if (c.watched.body.empty()) c.watched.body = d.model->all_bodies().back().name;
    const double end = options.end.value_or(d.end);
    c.instants.dt = end / static_cast<double>(c.instants.count);
    const double most = c.instants.dt * c.instants.stride;
    for (const double h : steps)
        if (h > most * (1 + 1e-9) || std::abs(end / h - std::round(end / h)) > 1e-6)
            throw UsageError(fmt::format(
                "study convergence: --steps must divide the end of {}, {} s, and be at most {:.4g} s, got {}",
                problem.name, end, most, h));
    return c;
}

void add_truth(Case& c, const StudyOptions& options)
{
    dae::Description d = ready(c.problem, options);
    std::vector<double> times;
    for (long k = 0; k <= c.instants.count; ++k) times.push_back(static_cast<double>(k) * c.instants.dt);
    c.truth = c.problem.truth(d, times);
    for (const lie::State& x : c.truth.row) dae::check_dropped_rows(*d.model, x);
    c.size = sizes(*d.model, c.truth, c.instants, c.watched);
}

/// Keeps the nodes that are instants of the truth, and what the invariants were there
class AtInstants final : public lie::Observer {
public:
    AtInstants(const dae::Model& model, const Instants& instants, double h)
        : model(model), instants(instants), h(h)
    {}

    void accepted(const lie::State& x, long n, int) override
    {
        dae::check_dropped_rows(model, x);
        const double k = static_cast<double>(n) * h / instants.dt;
        const long nearest = std::lround(k);
        if (nearest > instants.count || std::abs(k - static_cast<double>(nearest)) > 1e-6) return;
        at.push_back(nearest);
        run.row.push_back(x);
        constraint_norm = std::max(constraint_norm, model.largest_residual(x).value);
        for (const lie::Motion& body : x.body)
            orthogonality = std::max(orthogonality, lie::orthogonality_error(body.A));
    }

    std::vector<long> at;
    lie::Trajectory run;
    double constraint_norm = 0, orthogonality = 0;

private:
    const dae::Model& model;
    const Instants& instants;
    const double h;
};

struct Run {
    const Case* c = nullptr;
    const lie::Scheme* scheme = nullptr;
    double h = 0;

    Errors errors;
    std::array<bool, norm::count> at_floor{};
    std::array<double, norm::count> order{};
    lie::Statistics statistics;
    double constraint_norm = 0, orthogonality = 0, seconds = 0;
    std::string status = "ok", message;
};

/// One integration; errors, cost and invariants into `run`
void integrate(Run& run, const StudyOptions& options, const lie::Settings& settings)
{
    const Instants& instants = run.c->instants;
    const double t_end = instants.dt * static_cast<double>(instants.count);
    const dae::Description d = ready(run.c->problem, options);
    const auto integrator = run.scheme->make(*d.model, settings);
    AtInstants nodes(*d.model, instants, run.h);
    lie::Observer* observers[] = {&nodes};
    const double begin = thread_seconds();
    lie::March march(d.x, *integrator, run.h);
    const lie::Grid grid = lie::Grid::over(t_end, run.h);
    while (march.number() < grid.steps) march.advance(observers);
    run.statistics = integrator->statistics();
    run.seconds = thread_seconds() - begin;
    march.finish(observers);
    run.errors = errors(*d.model, nodes.run, nodes.at, run.c->truth, instants, run.c->watched);
    run.constraint_norm = nodes.constraint_norm;
    run.orthogonality = nodes.orthogonality;
}

void compute(Run& run, const StudyOptions& options)
{
    try {
        integrate(run, options, options.settings);
    } catch (const lie::NumericalFailure& failure) {
        run.status = failure.status;
        run.message = failure.what();
        run.errors.value.fill(std::nan(""));
        return;
    }
    Run tighter = run;
    try {
        lie::Settings settings = options.settings;
        settings.tolerance /= 100;
        integrate(tighter, options, settings);
    } catch (const lie::NumericalFailure&) {
        return;  // below rounding already; no floor to see
    }
    for (int n = 0; n < norm::count; ++n) {
        const double e = run.errors.value[n], e_tighter = tighter.errors.value[n];
        run.at_floor[n] = !(e > rounding * std::max(run.c->size.value[n], 1e-3)) ||
                          std::abs(e - e_tighter) > floor_change * e;
    }
}

/// The rows of one scheme on one problem, from the largest step down
using Series = std::vector<const Run*>;

double fit(const Series& series, int n)
{
    std::vector<double> h, e, h_small, e_small;
    for (const Run* run : series) {
        if (run->status != "ok" || run->at_floor[n]) continue;
        h.push_back(run->h), e.push_back(run->errors.value[n]);
        if (run->h <= asymptotic_step * (1 + 1e-9))
            h_small.push_back(run->h), e_small.push_back(run->errors.value[n]);
    }
    return h_small.size() >= 3 ? fitted_order(h_small, e_small) : fitted_order(h, e);
}

void print(const Series& series, std::ostream& out)
{
    const Run& first = *series.front();
    out << fmt::format("\n{}, {} (declared order {}, of lambda {}); truth: {}\n", first.c->problem.name,
                       first.scheme->name, first.scheme->order, first.scheme->order_lambda,
                       first.c->problem.truth_name);
    std::vector<Table::Column> columns = {{"h [s]", "{:.1e}"}};
    const char* heads[] = {"r [m]", "A", "v [m/s]", "omega [rad/s]", "Q"};
    for (int n = norm::r; n <= norm::Q; ++n) {
        columns.push_back({heads[n], "{}"});
        columns.push_back({"order", "{:.2f}"});
    }
    columns.insert(columns.end(), {{"iter", "{:.2f}"}, {"|Phi|", "{:.1e}"}, {"|A'A-I|", "{:.1e}"}});
    Table table(columns);
    for (const Run* run : series) {
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

Table as_table(const std::vector<Run>& runs)
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
    for (const Run& run : runs) {
        std::vector<Table::Cell> row = {run.c->problem.name, run.scheme->name, run.h,
                                        static_cast<double>(run.errors.instants), run.c->watched.name()};
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

ordered_json number(double value)
{
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json as_json(const std::vector<Series>& all, const StudyOptions& options)
{
    ordered_json out = {{"study", "convergence"},
                        {"tolerance", options.settings.tolerance},
                        {"set", options.set},
                        {"provenance", provenance(options.command_line, options.jobs)},
                        {"series", ordered_json::array()}};
    for (const Series& series : all) {
        const Run& first = *series.front();
        ordered_json fits = ordered_json::object(), rows = ordered_json::array();
        for (int n = 0; n < norm::count; ++n) fits[norm::names[n]] = number(fit(series, n));
        for (const Run* run : series) {
            ordered_json row = {{"h", run->h}, {"status", run->status}};
            if (!run->message.empty()) row["message"] = run->message;
            for (int n = 0; n < norm::count; ++n) row[norm::names[n]] = number(run->errors.value[n]);
            row["iterations_per_step"] = run->statistics.iterations_per_step();
            row["factorizations"] = run->statistics.factorizations;
            row["cpu_seconds"] = run->seconds;
            rows.push_back(row);
        }
        out["series"].push_back({{"problem", first.c->problem.name},
                                 {"integrator", first.scheme->name},
                                 {"declared_order", first.scheme->order},
                                 {"declared_order_lambda", first.scheme->order_lambda},
                                 {"truth", first.c->problem.truth_name},
                                 {"watched", first.c->watched.name()},
                                 {"fitted_order", fits},
                                 {"rows", rows}});
    }
    return out;
}

/// What --expect knows: order (of the first quantity whose order shows), order_r … order_watched, or an error by its
/// name at the smallest step
void check_key(const std::string& key)
{
    const std::string quantity = key.starts_with("order_") ? key.substr(6) : key;
    if (key != "order" && std::find(norm::names.begin(), norm::names.end(), quantity) == norm::names.end())
        throw UsageError(
            "study convergence: --expect knows order, order_X and X with X one of r, A, v, omega, Q, r_end, "
            "A_end, v_end, omega_end, watched, got '" +
            key + "'");
}

double value_of(const std::string& key, const Series& series)
{
    if (key == "order") {
        for (int n = 0; n < norm::count; ++n)
            if (const double p = fit(series, n); !std::isnan(p)) return p;
        return std::nan("");
    }
    const bool of_order = key.starts_with("order_");
    const auto name = std::find(norm::names.begin(), norm::names.end(), of_order ? key.substr(6) : key);
    const auto n = static_cast<int>(name - norm::names.begin());
    return of_order ? fit(series, n) : series.back()->errors.value[n];
}

/// Names what was expected and did not come, one line each; true when all came.
bool as_expected(const std::vector<Series>& all, const std::vector<Expectation>& expectations)
{
    bool met = true;
    for (const Expectation& e : expectations)
        for (const Series& series : all) {
            const double value = value_of(e.key, series);
            if (std::abs(value - e.value) <= e.tolerance) continue;
            met = false;
            message(fmt::format("hilda: error: expected {}, got {:.6g} for {} on {}\n", e.text, value,
                                series.front()->scheme->name, series.front()->c->problem.name));
        }
    return met;
}

std::vector<double> default_steps() { return {1e-2, 4e-3, 2e-3, 1e-3, 8e-4, 4e-4, 2e-4, 1e-4}; }

std::vector<std::string> default_problems()
{
    return {"double_pendulum", "double_pendulum_moving", "n_pendulum_2_spin", "slider_crank", "four_link"};
}

}  // namespace

int convergence(const StudyOptions& options)
{
    for (const Expectation& e : options.expect) check_key(e.key);
    std::vector<double> steps = options.steps.empty() ? default_steps() : options.steps;
    std::sort(steps.rbegin(), steps.rend());
    std::vector<const lie::Scheme*> chosen;
    for (const std::string& name : options.integrators) chosen.push_back(&lie::scheme(name));
    if (chosen.empty())
        for (const lie::Scheme& s : lie::schemes()) chosen.push_back(&s);

    // The problems are read here, one after the other, so that the first error is always the same one.
    std::vector<Case> cases;
    for (const std::string& name : options.problems.empty() ? default_problems() : options.problems) {
        cases.push_back(checked(problem_or_file(name), steps, options));
        for (size_t k = 0; k + 1 < cases.size(); ++k)
            if (cases[k].problem.name == cases.back().problem.name)
                throw UsageError("study convergence: two problems are called '" + cases[k].problem.name +
                                 "'");
    }
    Pool pool(options.jobs, options.quiet ? "" : "truth", static_cast<long>(cases.size()));
    pool.run([&](long k) { add_truth(cases[k], options); });

    std::vector<Run> runs;
    for (const Case& c : cases)
        for (const lie::Scheme* s : chosen)
            for (const double h : steps) {
                Run run;
                run.c = &c, run.scheme = s, run.h = h;
                run.order.fill(std::nan(""));
                runs.push_back(run);
            }

    // Small steps first: they take longest, and the last job to end decides when all have.
    std::vector<long> queue(runs.size());
    for (size_t k = 0; k < queue.size(); ++k) queue[k] = static_cast<long>(k);
    std::stable_sort(queue.begin(), queue.end(), [&](long a, long b) { return runs[a].h < runs[b].h; });
    Pool(options.jobs, options.quiet ? "" : "convergence", static_cast<long>(runs.size())).run([&](long k) {
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

    const ordered_json json = as_json(all, options);
    if (options.json)
        std::cout << json.dump(2) << '\n';
    else if (!options.quiet) {
        for (const Series& series : all) print(series, std::cout);
        std::cout << "\n* at rounding, or at the floor that the Newton tolerance sets: not in the fit, which "
                     "takes steps up to "
                     "1e-3 s\n";
    }
    if (!options.output.empty()) {
        write_file(options.output + "/study.csv", as_table(runs).csv());
        write_file(options.output + "/study.json", json.dump(2) + "\n");
        std::vector<std::string> written = {"study.csv", "study.json"};
        if (options.plot && plot("convergence.py", options.output))
            for (const Case& c : cases) written.push_back("convergence-" + c.problem.name + ".png");
        if (!options.json && !options.quiet) {
            std::cout << "\nwritten to " << options.output << ":";
            for (const std::string& file : written) std::cout << ' ' << file;
            std::cout << '\n';
        }
    }
    return as_expected(all, options.expect) ? 0 : 6;
}

namespace {

const bool enrolled =
    enrol(Study{.kind = "convergence",
                .answers = "order of the schemes against a trusted solution (Figs. 3.4, 3.6, 3.7, 3.8)",
                .run = convergence});

}  // namespace

}  // namespace hilda::studies
