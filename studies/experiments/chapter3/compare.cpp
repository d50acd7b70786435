// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of several integrators on one model with a reference solution.
///
/// compare.csv contains, for each row time, the observable and the position of its body of the reference
/// solution and of each integrator, and the differences in r, A, velocity and ω̄ (Euclidean norms over all
/// bodies, Frobenius norm for A). The table contains the largest and the final differences.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/csv.hpp"
#include "io/error.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

const std::string kind = "compare";
constexpr long min_rows = 100, max_rows = 1000;  // limits on the number of rows of compare.csv
constexpr std::array<const char*, 4> quantities = {"r", "A", "v", "omega"};

struct ComparedRun : Run {
    std::vector<lie::State> row;  ///< at the instants; fewer if the run failed
    std::vector<Difference> difference;
    std::array<double, 4> largest{}, last{};
};

/// The instants of compare.csv: every stride-th node, with a stride that gives between min_rows and max_rows
/// rows. A stride that divides the number of steps is preferred, so that the end of the run is a row. Without
/// such a divisor the run ends at the last instant.
Instants choose_instants(double end, double h)
{
    const long steps = std::lround(end / h), min_stride = (steps + max_rows - 1) / max_rows;
    long stride = min_stride;
    while (steps % stride != 0 && steps / stride > min_rows) ++stride;
    if (steps % stride != 0) stride = min_stride;
    return {.dt = static_cast<double>(stride) * h, .stride = 1, .count = steps / stride};
}

void compute(ComparedRun& run, const StudyOptions& options)
{
    const dae::Model& model = *run.c->started->model;
    AtInstants nodes(model, run.c->instants, run.h);
    lie::Observer* observers[] = {&nodes};
    march(run, options.settings, observers);
    for (size_t k = 0; k < nodes.at.size(); ++k)
        run.difference.push_back(difference(nodes.run.row[k], run.c->reference_solution.row[nodes.at[k]]));
    run.row = std::move(nodes.run.row);
    for (const Difference& d : run.difference) {
        run.last = {d.r, d.A, d.v, d.omega};
        for (size_t q = 0; q < 4; ++q) run.largest[q] = std::max(run.largest[q], run.last[q]);
    }
    if (run.failed()) run.last.fill(std::nan("")), run.largest.fill(std::nan(""));
}

Table as_table(const std::vector<ComparedRun>& runs)
{
    std::vector<Table::Column> columns = {{"problem"}, {"integrator"}, {"h"},
                                          {"rtol"},    {"reference"},  {"observable_scalar"}};
    for (const char* q : quantities) columns.push_back({std::string("max_") + q});
    for (const char* q : quantities) columns.push_back({std::string("end_") + q});
    for (const char* name : {"steps", "iterations_per_step", "cpu_seconds", "status"})
        columns.push_back({name});
    Table table(columns);
    for (const ComparedRun& run : runs) {
        const bool adaptive = run.rtol > 0;
        std::vector<Table::Cell> row = {run.c->problem.name,
                                        run.scheme->name,
                                        adaptive ? std::nan("") : run.h,
                                        adaptive ? run.rtol : std::nan(""),
                                        run.c->reference_name,
                                        run.c->observable.name()};
        for (const double d : run.largest) row.emplace_back(d);
        for (const double d : run.last) row.emplace_back(d);
        row.emplace_back(static_cast<double>(run.statistics.steps));
        row.emplace_back(run.statistics.iterations_per_step());
        row.emplace_back(run.seconds);
        row.emplace_back(run.status);
        table.add(row);
    }
    return table;
}

void print(const std::vector<ComparedRun>& runs, const Benchmark& c, std::ostream& out)
{
    std::vector<Table::Column> columns = {{"integrator"}, {"step or rtol"}};
    for (const char* heading : {"max dr [m]", "max dA", "max dv [m/s]", "max domega [rad/s]", "end dr [m]",
                                "end dA", "end dv [m/s]", "end domega [rad/s]"})
        columns.push_back({heading});
    columns.push_back({"status"});
    Table table(columns);
    for (const ComparedRun& run : runs) {
        std::vector<Table::Cell> row = {run.scheme->name, run.resolution()};
        for (const double d : run.largest) row.emplace_back(d);
        for (const double d : run.last) row.emplace_back(d);
        row.emplace_back(run.status);
        table.add(row);
    }
    out << fmt::format("\n{}, end time {:g} s, {} instants; reference solution: {}\n", c.problem.name, c.end,
                       c.instants.count + 1, c.reference_name);
    table.print(out);
}

/// Appends the observable and the position of its body.
void append(std::string& csv, const lie::State& x, const Observable& observable, int body)
{
    csv += ',';
    io::append_number(csv, component(x, body, observable.component));
    io::append_vector(csv, x.body[body].r);
}

std::string trajectories_csv(const Benchmark& c, const std::vector<ComparedRun>& runs)
{
    const int body = c.started->model->find(c.observable.body);
    std::string csv = "t";
    for (const char* column : {"observable", "rx", "ry", "rz"}) csv += std::string(",reference.") + column;
    for (const ComparedRun& run : runs)
        for (const char* column :
             {"observable", "rx", "ry", "rz", "diff_r", "diff_A", "diff_v", "diff_omega"})
            csv += ',' + io::csv_field(run.scheme->name + '.' + column);
    csv += '\n';
    for (long k = 0; k <= c.instants.count; ++k) {
        io::append_number(csv, static_cast<double>(k) * c.instants.dt);
        append(csv, c.reference_solution.row[k], c.observable, body);
        for (const ComparedRun& run : runs) {
            if (k >= static_cast<long>(run.row.size())) {  // the run failed before this instant
                csv += ",,,,,,,,";
                continue;
            }
            append(csv, run.row[k], c.observable, body);
            const Difference& d = run.difference[k];
            io::append_vector(csv, Eigen::Vector4d(d.r, d.A, d.v, d.omega));
        }
        csv += '\n';
    }
    return csv;
}

io::Json as_json(const std::vector<ComparedRun>& runs)
{
    io::Json rows = io::Json::array();
    for (const ComparedRun& run : runs) {
        io::Json row = as_json(static_cast<const Run&>(run));
        for (size_t q = 0; q < 4; ++q) row[std::string("max_") + quantities[q]] = run.largest[q];
        for (size_t q = 0; q < 4; ++q) row[std::string("end_") + quantities[q]] = run.last[q];
        row["steps"] = run.statistics.steps;
        row["iterations_per_step"] = run.statistics.iterations_per_step();
        rows.push_back(row);
    }
    return rows;
}

std::vector<std::string> keys()
{
    std::vector<std::string> all;
    for (const char* q : quantities)
        for (const char* when : {"max_", "end_"}) all.push_back(std::string(when) + q);
    return all;
}

int compare(const StudyOptions& options)
{
    check_keys(kind, options, keys());
    const double h = one_step(kind, options, 1e-3);
    const Schemes schemes = any_schemes(options, {"rA-half-1", "rA-half-2", "rA-full-1"});
    Evaluated evaluated;
    for (const lie::Scheme* s : schemes)
        if (s->adaptive)
            evaluated.smallest_rtol = options.settings.rtol;
        else
            evaluated.smallest_step = h,
            evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    if (options.problems.size() > 1) throw io::UsageError("study compare: takes one problem, --problem NAME");
    std::vector<Benchmark> all = benchmarks(kind, options, {"double_pendulum"});
    Benchmark& c = all.front();
    check_steps(kind, c, {h});
    c.instants = choose_instants(c.end, h);
    c.end = static_cast<double>(c.instants.count) * c.instants.dt;
    reference.evaluate(all);

    std::vector<ComparedRun> runs;
    for (const lie::Scheme* s : schemes) {
        ComparedRun run;
        run.c = &c, run.scheme = s, run.h = s->adaptive ? c.instants.dt : h;
        if (s->adaptive) run.rtol = options.settings.rtol;
        runs.push_back(run);
    }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    StudyOutput output{.kind = kind,
                       .table = as_table(runs).csv(),
                       .json = {{"reference", c.reference_name},
                                {"observable", c.observable.name()},
                                {"runs", as_json(runs)}},
                       .files = {{"compare.csv", trajectories_csv(c, runs)}},
                       .figures = {"compare.png"}};
    print(runs, c, output.text);
    std::vector<Measured> measurements;
    for (const ComparedRun& run : runs) {
        measurements.push_back({.of = run.name(), .value = {}});
        for (size_t q = 0; q < 4; ++q) {
            measurements.back().value[std::string("max_") + quantities[q]] = run.largest[q];
            measurements.back().value[std::string("end_") + quantities[q]] = run.last[q];
        }
    }
    return finish(options, output, run_pointers(runs), measurements);
}

const bool registered = register_study(Study{
    .kind = kind,
    .answers =
        "trajectories of several integrators on one model and their differences to the reference solution",
    .accepted = takes::reference,
    .run = compare});

}  // namespace

}  // namespace hilda::studies
