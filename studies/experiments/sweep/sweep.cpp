// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs of a model over a grid of values of its entries.
///
/// For each combination of the values of --sweep, each integrator and each step: the state of one body at the
/// end, the observed scalar at the end with its extrema over all nodes, energy, residuals, iterations, and
/// the largest resultant constraint force and torque on a body. The scalar is that of --observable, or that
/// of the problem. With --keep the motion of each run is written to runs/NUMBER, as CSV or HDF5 (--format).
/// All models are read and started before the first run, so that an invalid value ends the study at once. A
/// run that fails is a row with its status.

#include "studies/framework/sweep.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "run/columns/invariants.hpp"
#include "run/columns/output_columns.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/run_settings.hpp"
#include "run/tables/run_table.hpp"
#include "run/tables/sink.hpp"
#include "run/watch/run_check.hpp"
#include "studies/experiments/sweep/swept_model.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <limits>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 9> components = {"rx", "ry", "rz", "vx", "vy", "vz", "wx", "wy", "wz"};
constexpr double adaptive_rows = 1000;  // nodes of an adaptive scheme

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::array<double, 9> filled(double value)
{
    std::array<double, 9> all{};
    all.fill(value);
    return all;
}

/// Results of a run of the model
struct SweptRun : Run {
    std::vector<std::string> values = {};  ///< of the entries
    long number = 0;                       ///< of the row, from 1
    /// Up to the last node of the run; NaN without a node
    struct Results {
        double t = nan;                           ///< time reached [s]
        std::array<double, 9> end = filled(nan);  ///< components of the observed body
        double observed_end = nan, observed_least = nan, observed_most = nan;
        double energy_start = nan, energy_end = nan, energy_drift = nan;  ///< [J]
        double constraint_norm = nan, orthogonality = nan;                ///< [m or rad], 1
        double force = nan, torque = nan;                                 ///< largest on a body [N], [N m]
    } result;

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(result);
    }
};

/// Collects the results at all nodes, and passes the nodes to the sinks of a run that is kept.
class SweptNodes final : public lie::Observer {
public:
    SweptNodes(SweptRun::Results& to, const Benchmark& c, const std::string& observable,
               const lie::TimeGrid& grid)
        : to(to), model(*c.started->model), grid(grid), body(model.find(c.observable.body)),
          observed(model, c.started->outputs, "--observable", observable),
          contacts(run::evolving_contacts(model)), C(model.pattern())
    {}

    void accepted(const lie::State& x, long n, int iterations) override
    {
        const double energy = lie::energy(model, x), norm = model.largest_residual(x).value;
        invariants.update(model, contacts, x, energy, norm);
        if (sinks != nullptr)
            sinks->node(n, {.x = x,
                            .n = n,
                            .is_row = grid.is_row(n),
                            .energy = energy,
                            .constraint_norm = norm,
                            .iterations = iterations,
                            .cost = {}});
        to.t = x.t;
        for (size_t k = 0; k < components.size(); ++k) to.end[k] = component(x, body, components[k]);
        to.observed_end = observed.at(x);
        to.observed_least = n == 0 ? to.observed_end : std::min(to.observed_least, to.observed_end);
        to.observed_most = n == 0 ? to.observed_end : std::max(to.observed_most, to.observed_end);
        to.energy_start = invariants.energy_start, to.energy_end = invariants.energy_end;
        to.energy_drift = invariants.energy_drift;
        to.constraint_norm = invariants.constraint_norm, to.orthogonality = invariants.orthogonality;
        if (n == 0) to.force = to.torque = 0;
        dae::reactions(model, x, C, reactions);
        for (const dae::Reaction& on : reactions)
            to.force = std::max(to.force, on.F.norm()), to.torque = std::max(to.torque, on.T.norm());
        dae::check_dropped_rows(model, x);
    }

    io::Sinks<run::RunSetup>* sinks = nullptr;

private:
    SweptRun::Results& to;
    const dae::Model& model;
    const lie::TimeGrid& grid;
    const int body;
    run::ObservedColumn observed;
    const std::vector<const contact::EvolvingContact*> contacts;
    run::Invariants invariants;
    lie::Rows C;
    std::vector<dae::Reaction> reactions;
};

std::string folder_of(const StudyContext& s, long number)
{
    return fmt::format("{}/runs/{:04d}", s.output, number);
}

/// Removes the kept runs of an earlier study in the same directory.
void remove_kept(const StudyContext& s)
{
    std::error_code error;
    for (long number = 1; fs::is_directory(folder_of(s, number), error); ++number) {
        io::Sinks<run::RunSetup>::remove(folder_of(s, number));
        fs::remove(folder_of(s, number) + "/model.json", error);
        fs::remove(folder_of(s, number), error);
    }
    fs::remove(s.output + "/runs", error);
}

io::SinkOptions options_of_sinks(const StudyContext& s)
{
    io::SinkOptions all;
    if (!s.options.format.empty()) all[run::format_option] = s.options.format;
    return all;
}

void compute(SweptRun& run, const std::string& observable, const StudyContext& s)
{
    const Benchmark& c = *run.c;
    const lie::TimeGrid grid = lie::TimeGrid::over(c.end, run.h, c.end / adaptive_rows);
    SweptNodes nodes(run.result, c, observable, grid);
    std::optional<io::Sinks<run::RunSetup>> sinks;
    const std::string folder = folder_of(s, run.number);
    const io::SinkOptions sink_options = options_of_sinks(s);
    if (s.options.keep) {
        sinks.emplace(run::RunSetup{.model = *c.started->model,
                                    .outputs = c.started->outputs,
                                    .model_name = c.problem.name,
                                    .grid = grid,
                                    .end = c.end,
                                    .directory = folder,
                                    .options = sink_options,
                                    .warn = [](const std::string&) {},
                                    .tables = run::run_tables(sink_options, folder,
                                                              {{"program", run::version_line()},
                                                               {"integrator", run.scheme->name},
                                                               {"model", c.problem.name},
                                                               {"model_text", c.started->text}})});
        io::make_directory(folder);
        io::write_file(folder + "/model.json", c.started->text);
        sinks->open();
        nodes.sinks = &*sinks;
    }
    lie::Observer* observers[] = {&nodes};
    march(run, s.settings, observers);
    if (sinks) sinks->close();
}

/// A number for a JSON number, the text otherwise
Table::Cell cell_of(const std::string& value)
{
    const double number = io::finite_number_in(value);
    return std::isnan(number) ? Table::Cell(value) : Table::Cell(number);
}

Columns<SweptRun> columns_of(const std::vector<SweptEntry>& entries, const dae::Quantity& observable)
{
    using Results = SweptRun::Results;
    const auto value = [](double Results::*member) {
        return [member](const SweptRun& run) { return run.result.*member; };
    };
    std::vector<Column<SweptRun>> all = {{"run", "run", "{:.0f}", &SweptRun::number}};
    for (size_t e = 0; e < entries.size(); ++e)
        all.push_back({entries[e].pointer, entries[e].pointer, "{:.6g}",
                       [e](const SweptRun& run) { return cell_of(run.values[e]); }});
    all.push_back(column::integrator);
    all.push_back(column::h);
    all.push_back(column::rtol);
    all.push_back({"end", [](const SweptRun& run) { return run.c->end; }});
    all.push_back({"t", "t [s]", "{:.6g}", value(&Results::t)});
    const std::string unit = observable.unit.empty() ? "" : " [" + observable.unit + "]";
    all.push_back({"observable_end", observable.name + unit, "{:.6g}", value(&Results::observed_end)});
    all.push_back({"observable_min", "least", "{:.6g}", value(&Results::observed_least)});
    all.push_back({"observable_max", "largest", "{:.6g}", value(&Results::observed_most)});
    for (size_t k = 0; k < components.size(); ++k)
        all.push_back({components[k], [k](const SweptRun& run) { return run.result.end[k]; }});
    all.push_back({"energy_start", value(&Results::energy_start)});
    all.push_back({"energy_end", value(&Results::energy_end)});
    all.push_back({"energy_drift", "max |E-E0| [J]", "{:.3g}", value(&Results::energy_drift)});
    all.push_back({"constraint_norm", "residual", "{:.1e}", value(&Results::constraint_norm)});
    all.push_back({"orthogonality", value(&Results::orthogonality)});
    all.push_back({"max_force", "max F [N]", "{:.5g}", value(&Results::force)});
    all.push_back({"max_torque", "max T [N m]", "{:.5g}", value(&Results::torque)});
    all.push_back(column::steps);
    all.push_back(column::iterations);
    all.push_back(column::cpu_seconds);
    all.push_back(column::status);
    return Columns<SweptRun>(all);
}

void sweep(StudyContext& s)
{
    if (s.problems.size() > 1) s.refuse("takes one model");
    if (s.options.keep && s.output.empty()) s.refuse("--keep writes files: with --json it needs --output");
    if (!s.options.format.empty() && !s.options.keep) s.refuse("--format is for the motions of --keep");
    run::run_tables(options_of_sinks(s), s.output, {});  // before the first run, for a program without HDF5
    const std::vector<SweptEntry> entries = swept_entries(s.options.sweep);
    if (entries.empty())
        s.refuse("needs --sweep /json/pointer=VALUE,VALUE,... or --sweep /json/pointer=A:B:N");
    for (const std::string& change : s.set)
        for (const SweptEntry& entry : entries)
            if (change.starts_with(entry.pointer + '='))
                s.refuse("--set and --sweep change the same entry, " + entry.pointer);
    const std::string name = s.problems.empty() ? "double_pendulum" : s.problems.front();
    const SweptModel model(s.options, problem_or_file(name), entries);
    const Schemes schemes = s.schemes({run::default_integrator});
    const std::vector<double> steps = s.steps({1e-3});

    // The models are read again when they run: a grid of large models would not fit into the memory.
    std::vector<Benchmark> benchmarks;
    std::optional<dae::Quantity> observable;
    std::string observed_body;
    for (size_t k = 0; k < combinations(entries); ++k) {
        Benchmark& c = benchmarks.emplace_back();
        try {
            c = model.benchmark(k);
        } catch (const lie::NumericalFailure&) {  // at the start; its run reports it
            c.problem.name = model.name(k);
            c.end = s.options.end.value_or(0);
            continue;
        }
        if (!observable)
            observable =
                run::ObservedColumn(*c.started->model, c.started->outputs, "study sweep: --observable",
                                    s.options.observable.empty() ? c.observable.name() : s.options.observable)
                    .column();
        check_steps(s.name, c, steps);
        if (observed_body.empty()) {  // of the columns rx to wz: that of the observable, else of the problem
            const std::string prefix = observable->name.substr(0, observable->name.rfind('.'));
            const auto& bodies = c.started->model->all_bodies();
            const bool is_body = std::any_of(bodies.begin(), bodies.end(),
                                             [&](const dae::Body& body) { return body.name == prefix; });
            observed_body = is_body ? prefix : c.observable.body;
        }
        c.started.reset();
    }
    Sweep<SweptRun> runs;
    for (size_t k = 0; k < benchmarks.size(); ++k)
        for (const lie::Scheme* scheme : schemes)
            for (const double h :
                 scheme->adaptive ? std::vector<double>{benchmarks[k].end / adaptive_rows} : steps) {
                SweptRun& run = runs.add(benchmarks[k], *scheme, h, scheme->adaptive ? s.settings.rtol : 0);
                run.values = combination(entries, k);
                run.number = static_cast<long>(runs.size());
            }
    if (!s.output.empty() && !s.options.resume) remove_kept(s);
    runs.compute(s, [&](SweptRun& run) {
        struct Restore {
            SweptRun& run;
            const Benchmark* without_model = run.c;
            ~Restore() { run.c = without_model; }
        } const restore{run};
        Benchmark c = model.benchmark(static_cast<size_t>(run.c - benchmarks.data()));
        if (!observed_body.empty()) c.observable.body = observed_body;
        run.c = &c;
        compute(run, observable->name, s);
    });

    if (!observable) observable.emplace();  // no model has a consistent start
    const Columns<SweptRun> columns = columns_of(entries, *observable);
    s.text << fmt::format("\n{}, {}; {} at the end, its least and largest value\n", run::short_name(name),
                          io::counted(static_cast<long>(runs.size()), "run"), observable->name);
    std::vector<std::string> shown = {"run"};
    for (const SweptEntry& entry : entries) shown.push_back(entry.pointer);
    if (schemes.size() > 1) shown.emplace_back("integrator");
    if (steps.size() > 1) shown.emplace_back("h");
    for (const char* column : {"t", "observable_end", "observable_min", "observable_max", "energy_drift",
                               "constraint_norm", "max_force", "iterations_per_step", "status"})
        shown.emplace_back(column);
    columns.print(s.text, runs, shown);
    s.json["model"] = run::short_name(name);
    s.json["observable"] = observable->name;
    s.json["body"] = observed_body;
    s.json["observable_unit"] = observable->unit;
    for (const SweptEntry& entry : entries)
        s.json["sweep"].push_back({{"pointer", entry.pointer}, {"values", entry.values}});
    s.json["runs"] = columns.array(runs);
    s.figures = {"sweep.png"};
    s.every_run_must_succeed = true;
    s.results(columns, runs);
}

const bool registered_sweep = io::Registry<Study>::add(
    {.name = "sweep",
     .answers = "one model over a grid of values of its entries (--sweep): end states, energy, largest loads",
     .options = options_of_models({"--sweep", "--rtol", "--atol", "--strict", "--shard"}),
     .keys = {"observable_end", "observable_min", "observable_max", "energy_drift", "constraint_norm",
              "max_force", "max_torque"},
     .files = {"sweep.png"},
     .run = sweep});

}  // namespace

}  // namespace hilda::studies
