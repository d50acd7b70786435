// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of several integrators on one model with a reference solution.
///
/// compare.csv contains, for each row time, the observable and the position of its body of the reference
/// solution and of each integrator, and the differences in r, A, velocity and ω̄ (Euclidean norms over all
/// bodies, Frobenius norm for A). The table contains the largest and the final differences.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/formats/csv.hpp"
#include "studies/framework/evaluated_run.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

constexpr long min_rows = 100, max_rows = 1000;  // limits on the number of rows of compare.csv
constexpr std::array<const char*, 4> quantities = {"r", "A", "v", "omega"};

struct ComparedRun : Run {
    std::vector<lie::State> row;  ///< at the instants; fewer if the run failed
    std::vector<Difference> difference;
    std::array<double, 4> largest{}, last{};

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        size_t rows = row.size();
        a.count(rows, sizeof(double));
        row.resize(rows);
        for (lie::State& x : row) a.value(x.t), a.list(x.body);
        a.list(difference), a.value(largest), a.value(last);
    }
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

void compute(ComparedRun& run, const lie::Settings& settings)
{
    const dae::Model& model = *run.c->started->model;
    AtInstants nodes(model, run.c->instants, run.h);
    lie::Observer* observers[] = {&nodes};
    march(run, settings, observers);
    for (size_t k = 0; k < nodes.at.size(); ++k)
        run.difference.push_back(difference(nodes.run.row[k], run.c->reference_solution.row[nodes.at[k]]));
    run.row = std::move(nodes.run.row);
    for (const Difference& d : run.difference) {
        run.last = {d.r, d.A, d.v, d.omega};
        for (size_t q = 0; q < 4; ++q) run.largest[q] = std::max(run.largest[q], run.last[q]);
    }
    if (run.failed()) run.last.fill(std::nan("")), run.largest.fill(std::nan(""));
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

/// Columns of the largest or the last differences, for example max_r with the heading "max dr [m]"
Columns<ComparedRun> differences(const std::string& when, std::array<double, 4> ComparedRun::*values)
{
    constexpr std::array<const char*, 4> units = {" [m]", "", " [m/s]", " [rad/s]"};
    std::vector<Column<ComparedRun>> columns;
    for (size_t q = 0; q < 4; ++q)
        columns.push_back({when + '_' + quantities[q], when + " d" + quantities[q] + units[q],
                           [=](const ComparedRun& run) { return (run.*values)[q]; }});
    return Columns<ComparedRun>(columns);
}

void compare(StudyContext& s)
{
    const double h = s.one_step(1e-3), rtol = s.settings.rtol;
    const Schemes schemes = s.schemes({"rA-half-1", "rA-half-2", "rA-full-1"});
    const Reference reference(s, finest(schemes, h, rtol));
    if (s.problems.size() > 1) s.refuse("takes one problem, --problem NAME");
    std::vector<Benchmark> all = s.benchmarks({"double_pendulum"}, {h});
    Benchmark& c = all.front();
    c.instants = choose_instants(c.end, h);
    c.end = static_cast<double>(c.instants.count) * c.instants.dt;
    reference.evaluate(all);
    Sweep<ComparedRun> runs;
    for (const lie::Scheme* scheme : schemes)
        runs.add(c, *scheme, scheme->adaptive ? c.instants.dt : h, scheme->adaptive ? rtol : 0);
    runs.compute(s, [&](ComparedRun& run) { compute(run, s.settings); });

    const Columns<ComparedRun> columns =
        Columns<ComparedRun>{
            column::problem, column::integrator, column::resolution, Column<Run>(column::h).as(""),
            column::rtol,    column::reference,  column::observable} +
        differences("max", &ComparedRun::largest) + differences("end", &ComparedRun::last) +
        Columns<ComparedRun>{column::steps, Column<Run>(column::iterations).as(""), column::cpu_seconds,
                             column::status};
    s.text << fmt::format("\n{}, end time {:g} s, {} instants; reference solution: {}\n", c.problem.name,
                          c.end, c.instants.count + 1, c.reference_name);
    columns.print(s.text, runs);
    s.json = {{"reference", c.reference_name},
              {"observable", c.observable.name()},
              {"runs", columns.array(runs, {"max_r", "max_A", "max_v", "max_omega", "end_r", "end_A", "end_v",
                                            "end_omega", "steps", "iterations_per_step"})}};
    s.files = {{"compare.csv", trajectories_csv(c, runs)}};
    s.figures = {"compare.png"};
    s.results(columns, runs);
}

const bool registered_compare = io::Registry<Study>::add(
    {.name = "compare",
     .answers =
         "trajectories of several integrators on one model and their differences to the reference solution",
     .options = options_of_models({"--reference", "--rtol", "--atol", "--strict", "--shard"}),
     .keys = {"max_r", "end_r", "max_A", "end_A", "max_v", "end_v", "max_omega", "end_omega"},
     .files = {"compare.csv", "compare.png"},
     .run = compare});

}  // namespace

}  // namespace hilda::studies
