// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball in an ellipsoidal bowl with the contact points as unknowns (Fang 2022, Sec. 5.5.1, Figs. 5.2-5.6).
///
/// The ball is let go at the contact point (0, 1.5), from which it swings in a plane, and at (1, 1.5); it slides without
/// friction or rolls. SCENE.csv has the contact points on both bodies, the residuals of Ψ, N and G, the normal force, the
/// multipliers that must vanish and the change of energy at every node. The scene `loop` throws the ball right round the
/// ellipsoid, through normals that lie in the plane of x and y, with N projected on the tangents and, as (5.16) has it, on
/// the global x and y. --vtk N writes frames for ParaView. The table sets what comes out beside closed forms; --check does runs at half of the step too, and
/// exits with 6 where a demand is not met.

#include "studies/csv.hpp"
#include "studies/exit_codes.hpp"
#include "studies/experiments/chapter5/evolving_errors.hpp"
#include "studies/experiments/chapter5/evolving_reference.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/named_model.hpp"
#include "studies/running/model_frames.hpp"

#include "lie/check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using contact::EvolvingContact;
using nlohmann::ordered_json;
namespace norm = evolving_norm;

const std::string kind = "evolving-contact";
const std::string text = "rA-half-1", recommended = "rA-half-1-momentum";
constexpr size_t most_rows = 2000;  // of one run in a CSV
constexpr double usual_step = 5e-3, usual_end = 10;

struct BowlVariant {
    std::string name, problem, what;
    std::vector<std::string> set;
    double end = usual_end;
    bool rolls = false, loop = false;
};

const std::vector<BowlVariant> scenes = {
    {.name = "planar", .problem = "ball_in_bowl", .what = "from (0, 1.5), without friction", .set = {}},
    {.name = "xy", .problem = "ball_in_bowl_xy", .what = "from (1, 1.5), without friction", .set = {}},
    {.name = "planar-roll",
     .problem = "rolling_ball_in_bowl",
     .what = "from (0, 1.5), rolling",
     .set = {},
     .rolls = true},
    {.name = "xy-roll",
     .problem = "rolling_ball_in_bowl_xy",
     .what = "from (1, 1.5), rolling",
     .set = {},
     .rolls = true},
    {.name = "loop",
     .problem = "ball_in_bowl",
     .what = "from the bottom with 14 m/s, right round the ellipsoid",
     .set = {"/bodies/0/r=[0, 0, -1.5]", "/bodies/0/r_dot=[0, 14, 0]"},
     .end = 3,
     .loop = true}};

/// What a node says, in the order of the columns of SCENE.csv
enum : int {
    t,
    aj_x,
    aj_y,
    aj_z,
    ai_x,
    ai_y,
    ai_z,
    Psi,
    N,
    G,
    F_N,
    lambda_N,
    lambda_t,
    friction,
    energy,
    y,
    speed,
    n_z,
    samples
};
constexpr std::array<const char*, samples> columns = {
    "t", "aj_x", "aj_y",     "aj_z",     "ai_x",     "ai_y",          "ai_z", "Psi",   "N",
    "G", "F_N",  "lambda_N", "lambda_t", "friction", "energy_change", "y",    "speed", "n_z"};
using Sample = std::array<double, samples>;

struct BowlRun : Run {
    const BowlVariant* scene = nullptr;
    std::string rows;
    bool for_check = false;
    std::vector<Sample> sample;
    std::array<double, norm::count> error{};

    std::string label() const { return scheme->name + (rows == "tangent" ? "" : ", " + rows); }
    double largest(int column) const
    {
        double most = 0;
        for (const Sample& s : sample)
            if (!(std::abs(s[column]) <= most) && !std::isnan(s[column])) most = std::abs(s[column]);
        return most;
    }
};

/// Samples every node. The text stores velocities of the middle of a step: its energy at a node is that of the mean of
/// two of them.
class Watch final : public lie::Observer {
public:
    Watch(BowlRun& run, bool between)
        : run(run), model(*run.c->started->model), contact(*evolving_contacts(model).front()),
          at_start(lie::energy(model, run.c->started->x)), between(between)
    {}

    void accepted(const lie::State& x, long /*n*/, int) override
    {
        const dae::Constraint::At at = model.at(contact, x);
        const EvolvingContact::Multipliers of = contact.multipliers(at, x.lambda);
        double Phi[7];
        contact.phi(at, Phi);
        Sample s{};
        s[t] = x.t;
        for (int k = 0; k < 3; ++k) s[ai_x + k] = x.alpha[k], s[aj_x + k] = x.alpha[3 + k];
        s[Psi] = lie::Vec3::Map(Phi).norm(), s[N] = std::hypot(Phi[3], Phi[4]),
        s[G] = std::hypot(Phi[5], Phi[6]);
        s[F_N] = of.F_N, s[lambda_N] = of.N.norm(), s[lambda_t] = of.tangential.norm();
        s[friction] = of.friction.norm();
        s[energy] = lie::energy(model, x) - at_start;
        s[y] = x.body[0].r.y(), s[speed] = x.body[0].rdot.norm(), s[n_z] = contact.contact_point(at).n.z();
        if (between && !run.sample.empty()) {
            last.body[0].rdot = 0.5 * (last.body[0].rdot + x.body[0].rdot);
            last.body[0].omega_bar = 0.5 * (last.body[0].omega_bar + x.body[0].omega_bar);
            run.sample.back()[energy] = lie::energy(model, last) - at_start;
            run.sample.back()[speed] = last.body[0].rdot.norm();
        }
        if (between) s[energy] = std::nan("");  // until the next node is known
        run.sample.push_back(s);
        last = x;
    }

private:
    BowlRun& run;
    const dae::Model& model;
    const EvolvingContact& contact;
    const double at_start;
    const bool between;
    lie::State last;
};

void compute(BowlRun& run, const StudyOptions& options)
{
    ReferenceErrors against(*run.c, run.h);
    Watch watch(run, run.scheme->name == text);
    std::vector<lie::Observer*> observers = {&watch, &against};
    std::optional<ModelFrames> frames;
    if (options.vtk > 0 && !run.for_check) {
        frames.emplace(*run.c->started->model, EvenChoice(options.vtk, std::lround(run.c->end / run.h)));
        observers.push_back(&*frames);
    }
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-14);  // residuals are shown down to rounding
    march(run, settings, observers);
    run.error = against.error;
    if (run.failed()) run.error.fill(std::nan(""));
    const std::string name =
        run.scene->name + '-' + run.scheme->name + (run.rows == "tangent" ? "" : '-' + run.rows);
    if (options.force && !options.output.empty()) Snapshots::remove(options.output, name);
    if (frames) frames->snapshots.write(options.output, name);
}

/// Of a quantity at its largest node, by a parabola through it and its neighbours
double peak(const BowlRun& run, int column)
{
    const auto& s = run.sample;
    size_t k = 0;
    for (size_t i = 1; i < s.size(); ++i)
        if (s[i][column] > s[k][column]) k = i;
    if (k == 0 || k + 1 >= s.size()) return s.empty() ? std::nan("") : s[k][column];
    const double a = s[k - 1][column], b = s[k][column], c = s[k + 1][column], curvature = a - 2 * b + c;
    return curvature == 0 ? b : b - (a - c) * (a - c) / (8 * curvature);
}

/// Between the first and the last passage of y = 0 downwards
double period(const BowlRun& run)
{
    std::vector<double> down;
    for (size_t k = 1; k < run.sample.size(); ++k) {
        const Sample &before = run.sample[k - 1], &after = run.sample[k];
        if (before[y] > 0 && after[y] <= 0)
            down.push_back(before[t] + (after[t] - before[t]) * before[y] / (before[y] - after[y]));
    }
    return down.size() < 2 ? std::nan("")
                           : (down.back() - down.front()) / static_cast<double>(down.size() - 1);
}

double F_N_at_start(const Benchmark& c)
{
    const dae::Model& model = *c.started->model;
    const EvolvingContact& of = *evolving_contacts(model).front();
    return of.multipliers(model.at(of, c.started->x), c.started->x.lambda).F_N;
}

double friction_at_start(const Benchmark& c)
{
    const dae::Model& model = *c.started->model;
    const EvolvingContact& of = *evolving_contacts(model).front();
    return of.multipliers(model.at(of, c.started->x), c.started->x.lambda).friction.norm();
}

/// What an error of position and of normal force may be at the usual step, and, of the planar swing, the energy
struct Bounds {
    double r, F_N, energy;
};
Bounds bounds(const BowlRun& run)
{
    const bool planar = run.scene->name == "planar";
    if (run.scheme->name == text) return planar ? Bounds{6e-3, 7.8e-3, 4e-5} : Bounds{6.4e-3, 9e-3, 0};
    return planar ? Bounds{7e-5, 9.5e-5, 4e-5} : Bounds{7e-5, 1e-4, 0};
}

/// Closed forms of the planar swing: F_N and the speed at the bottom, the period
struct Swing {
    double F_N, speed, period;
};
constexpr Swing sliding = {10.960602417068388, 2.145322742217019, 3.918321172588791},
                rolling = {10.631858869334563, 1.8131286433505626, 4.636220134568755};

void evaluate_run(const BowlRun& run, const BowlRun* half, std::vector<Criterion>& must)
{
    const std::string of = ", " + run.scene->name + " by " + run.label();
    must.push_back(between("residual of Psi, N, G [m]" + of,
                           std::max({run.largest(Psi), run.largest(N), run.largest(G)}), 0, 8e-15));
    const double F = run.largest(F_N);
    must.push_back(between("|lambda_N| over F_N" + of, run.largest(lambda_N) / F, 0, 1e-12));
    must.push_back(between("tangential part of lambda over F_N" + of, run.largest(lambda_t) / F, 0, 1e-12));
    if (run.h != usual_step || run.c->end != usual_end) return;
    const bool is_text = run.scheme->name == text;
    if (!is_text && run.scheme->name != recommended) return;
    const bool planar = run.scene->name == "planar";
    if (!run.scene->rolls) {
        const Bounds b = bounds(run);
        must.push_back(between("error of position [m]" + of, run.error[norm::r], 0, b.r));
        must.push_back(between("error of the normal force [N]" + of, run.error[norm::F_N], 0, b.F_N));
        if (planar) must.push_back(between("change of energy [J]" + of, run.largest(energy), 0, b.energy));
        if (half != nullptr && !half->failed())
            must.push_back(criterion("that over that of half of the step" + of,
                                     run.largest(energy) / half->largest(energy), 4, 0.2));
    }
    if (half != nullptr && !half->failed())
        must.push_back(criterion("order of position" + of,
                                 std::log2(run.error[norm::r] / half->error[norm::r]), is_text ? 1 : 2,
                                 0.03));
    if (!planar && run.scene->name != "planar-roll") return;
    const Swing& swing = run.scene->rolls ? rolling : sliding;
    const double tolerance = is_text ? 5e-3 : 1e-4;
    must.push_back(criterion("F_N at the bottom [N]" + of, peak(run, F_N), swing.F_N, tolerance));
    must.push_back(criterion("speed at the bottom [m/s]" + of, peak(run, speed), swing.speed, tolerance));
    must.push_back(criterion("period [s]" + of, period(run), swing.period, tolerance));
}

void evaluate_starts(const std::vector<Benchmark>& benchmarks,
                     const std::vector<const BowlVariant*>& selected, std::vector<Criterion>& must)
{
    for (size_t k = 0; k < selected.size(); ++k) {
        const BowlVariant& s = *selected[k];
        if (s.name == "planar")
            must.push_back(
                criterion("F_N(0) [N], planar", F_N_at_start(benchmarks[k]), 9.155246512774925, 1e-11));
        if (s.name == "xy")
            must.push_back(
                criterion("F_N(0) [N], xy", F_N_at_start(benchmarks[k]), 9.014262047215154, 1e-11));
        if (s.name == "planar-roll")
            must.push_back(criterion("friction at release [N], planar-roll", friction_at_start(benchmarks[k]),
                                     1.006816007361521, 1e-11));
    }
}

/// The loop goes through n_z = 0, which the tangents do not feel and the global x and y do not survive.
void evaluate_loop(const BowlRun& run, std::vector<Criterion>& must)
{
    const std::string of = ", loop by " + run.label();
    double least = 1, most = -1;
    for (const Sample& s : run.sample) least = std::min(least, s[n_z]), most = std::max(most, s[n_z]);
    if (run.rows == "tangent") {
        must.push_back(between("reaches the end [s]" + of, run.failed() ? std::nan("") : run.sample.back()[t],
                               run.c->end - 1e-9, run.c->end + run.h));
        must.push_back(between("least n_z" + of, least, -1, -0.99));
        must.push_back(between("largest n_z" + of, most, 0.99, 1));
        must.push_back(between("residual of Psi, N, G [m]" + of,
                               std::max({run.largest(Psi), run.largest(N), run.largest(G)}), 0, 1e-12));
    } else {
        must.push_back(between("last node before it fails [s]" + of,
                               run.failed() ? run.sample.back()[t] : run.c->end, 0, 0.99 * run.c->end));
    }
}

std::string curves(const std::vector<const BowlRun*>& runs)
{
    std::string csv = "run,h";
    for (const char* column : columns) csv += std::string(",") + column;
    csv += '\n';
    for (const BowlRun* run : runs) {
        const size_t every = std::max<size_t>(1, (run->sample.size() + most_rows - 1) / most_rows);
        for (size_t k = 0; k < run->sample.size(); k += every) {
            csv += csv_field(run->label()) + ',';
            append_number(csv, run->h);
            for (const double value : run->sample[k]) {
                csv += ',';
                if (!std::isnan(value)) append_number(csv, value);
            }
            csv += '\n';
        }
    }
    return csv;
}

Table as_table(const std::vector<BowlRun>& runs)
{
    Table table({{"scene"},
                 {"integrator"},
                 {"rows"},
                 {"h"},
                 {"error_r"},
                 {"error_alpha"},
                 {"error_F_N"},
                 {"Psi"},
                 {"N"},
                 {"G"},
                 {"lambda_N"},
                 {"lambda_t"},
                 {"energy_change"},
                 {"F_N_most"},
                 {"iterations_per_step"},
                 {"cpu_seconds"},
                 {"status"}});
    for (const BowlRun& run : runs)
        table.add({run.scene->name, run.scheme->name, run.rows, run.h, run.error[norm::r],
                   run.error[norm::alpha], run.error[norm::F_N], run.largest(Psi), run.largest(N),
                   run.largest(G), run.largest(lambda_N), run.largest(lambda_t), run.largest(energy),
                   run.largest(F_N), run.statistics.iterations_per_step(), run.seconds, run.status});
    return table;
}

void print(const std::vector<const BowlRun*>& runs, const BowlVariant& s, std::ostream& out)
{
    Table table({{s.name},
                 {"h [s]", "{:.2e}"},
                 {"r [m]", "{:.2e}"},
                 {"alpha [m]", "{:.2e}"},
                 {"F_N [N]", "{:.2e}"},
                 {"Psi, N, G [m]", "{:.1e}"},
                 {"lambda_N, _t [N]", "{:.1e}"},
                 {"E-E0 [J]", "{:.1e}"},
                 {"iter", "{:.2f}"},
                 {"status"}});
    for (const BowlRun* run : runs)
        table.add({run->label(), run->h, run->error[norm::r], run->error[norm::alpha], run->error[norm::F_N],
                   std::max({run->largest(Psi), run->largest(N), run->largest(G)}),
                   std::max(run->largest(lambda_N), run->largest(lambda_t)), run->largest(energy),
                   run->statistics.iterations_per_step(), run->status});
    out << fmt::format("\n{}: a ball in a bowl, {}; errors against {}\n", s.name, s.what,
                       runs.front()->c->reference_name);
    table.print(out);
}

std::vector<const BowlVariant*> selected_variants(const StudyOptions& options)
{
    std::vector<std::string> known;
    for (const BowlVariant& s : scenes) known.push_back(s.name);
    for (const std::string& name : options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw UsageError("study " + kind + ": unknown scene" + with_nearest(name, known));
    std::vector<const BowlVariant*> selected;
    for (const BowlVariant& s : scenes)
        if (options.problems.empty() ||
            std::find(options.problems.begin(), options.problems.end(), s.name) != options.problems.end())
            selected.push_back(&s);
    return selected;
}

/// The settings of the scene go into the text of its model, of which the truth is made too.
Benchmark benchmark_of(const BowlVariant& s, const StudyOptions& options, const std::string& rows)
{
    Problem of = problem(s.problem);
    of.model = dae::read_model(of.model, of.name, normal_rows(s.problem, s.set, rows)).text;
    return make_benchmark(std::move(of), options, [&](const dae::Description&) { return s.end; });
}

int study(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"r", "alpha", "F_N", "energy"});
    check_vtk(kind, options);
    const double h = one_step(kind, options, usual_step);
    const Schemes schemes = fixed_step_schemes(kind, options, {text, recommended});
    const std::string rows = options.normal_rows.empty() ? "tangent" : options.normal_rows;
    const std::vector<const BowlVariant*> selected = selected_variants(options);
    Evaluated evaluated{.smallest_step = h};
    for (const lie::Scheme* s : schemes)
        evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    std::vector<Benchmark> benchmarks, fixed;  // fixed: the loop again, with the global x and y
    for (const BowlVariant* s : selected) {
        benchmarks.push_back(benchmark_of(*s, options, rows));
        check_steps(kind, benchmarks.back(), {h},
                    benchmarks.back().instants.dt * benchmarks.back().instants.stride);
        if (s->loop && options.normal_rows.empty()) fixed.push_back(benchmark_of(*s, options, "fixed-xy"));
    }
    reference.evaluate(benchmarks);
    for (Benchmark& c : fixed)
        for (size_t k = 0; k < selected.size(); ++k)
            if (selected[k]->loop) c.reference_solution = benchmarks[k].reference_solution;

    std::vector<BowlRun> runs;
    const auto add = [&](const Benchmark& c, const BowlVariant& s, const lie::Scheme& scheme,
                         const std::string& with, double step, bool for_check) {
        BowlRun run;
        run.c = &c, run.scheme = &scheme, run.h = step;
        run.scene = &s, run.rows = with, run.for_check = for_check;
        runs.push_back(std::move(run));
    };
    for (size_t k = 0; k < selected.size(); ++k)
        for (const lie::Scheme* scheme : schemes) {
            add(benchmarks[k], *selected[k], *scheme, rows, h, false);
            if (options.check && !selected[k]->loop)
                add(benchmarks[k], *selected[k], *scheme, rows, h / 2, true);
            for (const Benchmark& c : fixed)
                if (selected[k]->loop) add(c, *selected[k], *scheme, "fixed-xy", h, false);
        }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    StudyOutput output{.kind = kind, .table = as_table(runs).csv()};
    std::vector<Criterion> must;
    evaluate_starts(benchmarks, selected, must);
    std::vector<Measured> came;
    std::vector<const Run*> to_end;  // but those whose failure is what is shown
    for (const BowlVariant* s : selected) {
        std::vector<const BowlRun*> shown, drawn;
        for (const BowlRun& run : runs) {
            if (run.scene != s) continue;
            shown.push_back(&run);
            if (!run.for_check) drawn.push_back(&run);
            if (run.rows == rows) to_end.push_back(&run);
            if (s->loop) evaluate_loop(run, must);
            if (run.for_check || s->loop) continue;
            const auto half = std::find_if(runs.begin(), runs.end(), [&](const BowlRun& other) {
                return other.for_check && other.scene == s && other.scheme == run.scheme;
            });
            evaluate_run(run, half == runs.end() ? nullptr : &*half, must);
            came.push_back({.of = run.label() + " on " + s->name,
                            .value = {{"r", run.error[norm::r]},
                                      {"alpha", run.error[norm::alpha]},
                                      {"F_N", run.error[norm::F_N]},
                                      {"energy", run.largest(energy)}}});
        }
        print(shown, *s, output.text);
        output.files.emplace_back(s->name + ".csv", curves(drawn));
        output.figures.push_back(kind + '-' + s->name + ".png");
    }
    const bool passed = evaluate(must, output.text, output.json);
    if (!options.check) output.text << "--check does runs at half of the step too, and judges by all\n";
    const int code = finish(options, output, to_end, came);
    return code == exit_code::done && options.check && !passed ? exit_code::expectation_failed : code;
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "ball in a bowl with the contact points as unknowns (Figs. 5.2-5.6)",
                         .also = takes::reference | takes::check | takes::vtk | takes::normal_rows,
                         .run = study});

}  // namespace

}  // namespace hilda::studies
