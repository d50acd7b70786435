// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball in an ellipsoidal bowl with the contact points as unknowns (Fang 2022, Sec. 5.5.1, Figs. 5.2-5.6).
///
/// The ball is released from rest at the contact point (0, 1.5), where its motion is planar, and at (1, 1.5).
/// It either slides without friction or rolls without slip. SCENE.csv contains, at every node, the contact
/// points on both bodies, the residuals of Ψ, N and G, the normal force, the multipliers that vanish for the
/// exact solution, and the change of energy.
///
/// In the scene `loop` the ball runs around the inside of the whole ellipsoid and passes points where the
/// normal is horizontal (n_z = 0). The rows N are projected on the surface tangents and, as in Eq. 5.16, on
/// the global x and y axes. The second choice is singular at n_z = 0.
///
/// The results are compared with closed forms. --vtk N writes frames for ParaView. --check adds runs with
/// half of the step and returns exit code 6 if an acceptance criterion fails.

#include "io/csv.hpp"
#include "io/error.hpp"
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

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using contact::EvolvingContact;
namespace norm = evolving_norm;

const std::string kind = "evolving-contact";
const std::string dissertation_scheme = "rA-half-1", recommended_scheme = "rA-half-1-momentum";
constexpr size_t max_rows = 2000;  // limit on the rows per run in SCENE.csv
constexpr double default_step = 5e-3, default_end = 10;

struct BowlVariant {
    std::string name, problem, what;
    std::vector<std::string> set;
    double end = default_end;
    bool rolls = false, loop = false;
};

const std::vector<BowlVariant> variants = {
    {.name = "planar", .problem = "ball_in_bowl", .what = "released at (0, 1.5), frictionless", .set = {}},
    {.name = "xy", .problem = "ball_in_bowl_xy", .what = "released at (1, 1.5), frictionless", .set = {}},
    {.name = "planar-roll",
     .problem = "rolling_ball_in_bowl",
     .what = "released at (0, 1.5), rolling",
     .set = {},
     .rolls = true},
    {.name = "xy-roll",
     .problem = "rolling_ball_in_bowl_xy",
     .what = "released at (1, 1.5), rolling",
     .set = {},
     .rolls = true},
    {.name = "loop",
     .problem = "ball_in_bowl",
     .what = "started at the bottom with 14 m/s, around the whole ellipsoid",
     .set = {"/bodies/0/r=[0, 0, -1.5]", "/bodies/0/r_dot=[0, 14, 0]"},
     .end = 3,
     .loop = true}};

/// Quantities recorded at every node, in the order of the columns of SCENE.csv
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
    sample_size
};
constexpr std::array<const char*, sample_size> columns = {
    "t", "aj_x", "aj_y",     "aj_z",     "ai_x",     "ai_y",          "ai_z", "Psi",   "N",
    "G", "F_N",  "lambda_N", "lambda_t", "friction", "energy_change", "y",    "speed", "n_z"};
using BowlSample = std::array<double, sample_size>;

struct BowlRun : Run {
    const BowlVariant* variant = nullptr;
    std::string rows;
    bool for_check = false;
    std::vector<BowlSample> sample;
    std::array<double, norm::count> error{};

    std::string label() const { return scheme->name + (rows == "tangent" ? "" : ", " + rows); }
    double largest(int column) const
    {
        double most = 0;
        for (const BowlSample& s : sample)
            if (!(std::abs(s[column]) <= most) && !std::isnan(s[column])) most = std::abs(s[column]);
        return most;
    }
};

/// Records every node.
///
/// rA-half-1 stores the velocities of the middle of the step (v_{n-1/2}). The energy at a node is then
/// computed with the mean of the velocities before and after it, so it is available one step later.
class BowlSampler final : public lie::Observer {
public:
    BowlSampler(BowlRun& run, bool half_step_velocities)
        : run(run), model(*run.c->started->model), contact(*evolving_contacts(model).front()),
          initial_energy(lie::energy(model, run.c->started->x)), half_step_velocities(half_step_velocities)
    {}

    void accepted(const lie::State& x, long /*n*/, int) override
    {
        const dae::Constraint::Arguments at = model.arguments(contact, x);
        const EvolvingContact::Multipliers multipliers = contact.multipliers(at, x.lambda);
        double Phi[7];
        contact.phi(at, Phi);
        BowlSample s{};
        s[t] = x.t;
        for (int k = 0; k < 3; ++k) s[ai_x + k] = x.alpha[k], s[aj_x + k] = x.alpha[3 + k];
        s[Psi] = lie::Vec3::Map(Phi).norm(), s[N] = std::hypot(Phi[3], Phi[4]),
        s[G] = std::hypot(Phi[5], Phi[6]);
        s[F_N] = multipliers.F_N, s[lambda_N] = multipliers.N.norm(),
        s[lambda_t] = multipliers.tangential.norm();
        s[friction] = multipliers.friction.norm();
        s[energy] = lie::energy(model, x) - initial_energy;
        s[y] = x.body[0].r.y(), s[speed] = x.body[0].rdot.norm(), s[n_z] = contact.contact_point(at).n.z();
        if (half_step_velocities && !run.sample.empty()) {
            last.body[0].rdot = 0.5 * (last.body[0].rdot + x.body[0].rdot);
            last.body[0].omega_bar = 0.5 * (last.body[0].omega_bar + x.body[0].omega_bar);
            run.sample.back()[energy] = lie::energy(model, last) - initial_energy;
            run.sample.back()[speed] = last.body[0].rdot.norm();
        }
        if (half_step_velocities) s[energy] = std::nan("");  // set when the next node is available
        run.sample.push_back(s);
        last = x;
    }

private:
    BowlRun& run;
    const dae::Model& model;
    const EvolvingContact& contact;
    const double initial_energy;
    const bool half_step_velocities;
    lie::State last;
};

void compute(BowlRun& run, const StudyOptions& options)
{
    ReferenceErrors comparison(*run.c, run.h);
    BowlSampler sampler(run, run.scheme->name == dissertation_scheme);
    std::vector<lie::Observer*> observers = {&sampler, &comparison};
    std::optional<ModelFrames> frames;
    if (options.vtk > 0 && !run.for_check) {
        frames.emplace(*run.c->started->model, EvenSelection(options.vtk, std::lround(run.c->end / run.h)));
        observers.push_back(&*frames);
    }
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-14);  // residuals down to rounding
    march(run, settings, observers);
    run.error = comparison.error;
    if (run.failed()) run.error.fill(std::nan(""));
    const std::string name =
        run.variant->name + '-' + run.scheme->name + (run.rows == "tangent" ? "" : '-' + run.rows);
    if (options.force && !options.output.empty()) Snapshots::remove(options.output, name);
    if (frames) frames->snapshots.write(options.output, name);
}

/// Maximum of a recorded quantity, from a parabola through the largest sample and its two neighbours
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

/// Mean period [s], from the first to the last downward crossing of y = 0 (linear interpolation between
/// nodes)
double period(const BowlRun& run)
{
    std::vector<double> down;
    for (size_t k = 1; k < run.sample.size(); ++k) {
        const BowlSample &before = run.sample[k - 1], &after = run.sample[k];
        if (before[y] > 0 && after[y] <= 0)
            down.push_back(before[t] + (after[t] - before[t]) * before[y] / (before[y] - after[y]));
    }
    return down.size() < 2 ? std::nan("")
                           : (down.back() - down.front()) / static_cast<double>(down.size() - 1);
}

double F_N_at_start(const Benchmark& c)
{
    const dae::Model& model = *c.started->model;
    const EvolvingContact& contact = *evolving_contacts(model).front();
    return contact.multipliers(model.arguments(contact, c.started->x), c.started->x.lambda).F_N;
}

double friction_at_start(const Benchmark& c)
{
    const dae::Model& model = *c.started->model;
    const EvolvingContact& contact = *evolving_contacts(model).front();
    return contact.multipliers(model.arguments(contact, c.started->x), c.started->x.lambda).friction.norm();
}

/// Largest accepted errors of position [m] and normal force [N] at the default step, and for the planar
/// motion the largest accepted change of energy [J]
struct ErrorBounds {
    double r, F_N, energy;
};
ErrorBounds bounds(const BowlRun& run)
{
    const bool planar = run.variant->name == "planar";
    if (run.scheme->name == dissertation_scheme)
        return planar ? ErrorBounds{6e-3, 7.8e-3, 4e-5} : ErrorBounds{6.4e-3, 9e-3, 0};
    return planar ? ErrorBounds{7e-5, 9.5e-5, 4e-5} : ErrorBounds{7e-5, 1e-4, 0};
}

/// Closed forms of the planar motion: normal force [N] and speed [m/s] at the bottom, period [s]
struct PlanarSwing {
    double F_N, speed, period;
};
constexpr PlanarSwing sliding_swing = {10.960602417068388, 2.145322742217019, 3.918321172588791},
                      rolling_swing = {10.631858869334563, 1.8131286433505626, 4.636220134568755};

void check_run(const BowlRun& run, const BowlRun* half, std::vector<Criterion>& checks)
{
    const std::string suffix = ", " + run.variant->name + " by " + run.label();
    checks.push_back(between("residual of Psi, N, G [m]" + suffix,
                             std::max({run.largest(Psi), run.largest(N), run.largest(G)}), 0, 8e-15));
    const double F = run.largest(F_N);
    checks.push_back(between("|lambda_N| over F_N" + suffix, run.largest(lambda_N) / F, 0, 1e-12));
    checks.push_back(
        between("tangential part of lambda over F_N" + suffix, run.largest(lambda_t) / F, 0, 1e-12));
    if (run.h != default_step || run.c->end != default_end) return;
    const bool is_dissertation_scheme = run.scheme->name == dissertation_scheme;
    if (!is_dissertation_scheme && run.scheme->name != recommended_scheme) return;
    const bool planar = run.variant->name == "planar";
    if (!run.variant->rolls) {
        const ErrorBounds b = bounds(run);
        checks.push_back(between("error of position [m]" + suffix, run.error[norm::r], 0, b.r));
        checks.push_back(between("error of the normal force [N]" + suffix, run.error[norm::F_N], 0, b.F_N));
        if (planar)
            checks.push_back(between("change of energy [J]" + suffix, run.largest(energy), 0, b.energy));
        if (half != nullptr && !half->failed())
            checks.push_back(criterion("change of energy over that with half of the step" + suffix,
                                       run.largest(energy) / half->largest(energy), 4, 0.2));
    }
    if (half != nullptr && !half->failed())
        checks.push_back(criterion("order of position" + suffix,
                                   std::log2(run.error[norm::r] / half->error[norm::r]),
                                   is_dissertation_scheme ? 1 : 2, 0.03));
    if (!planar && run.variant->name != "planar-roll") return;
    const PlanarSwing& swing = run.variant->rolls ? rolling_swing : sliding_swing;
    const double tolerance = is_dissertation_scheme ? 5e-3 : 1e-4;
    checks.push_back(criterion("F_N at the bottom [N]" + suffix, peak(run, F_N), swing.F_N, tolerance));
    checks.push_back(
        criterion("speed at the bottom [m/s]" + suffix, peak(run, speed), swing.speed, tolerance));
    checks.push_back(criterion("period [s]" + suffix, period(run), swing.period, tolerance));
}

void check_initial_forces(const std::vector<Benchmark>& benchmarks,
                          const std::vector<const BowlVariant*>& selected, std::vector<Criterion>& checks)
{
    for (size_t k = 0; k < selected.size(); ++k) {
        const BowlVariant& s = *selected[k];
        if (s.name == "planar")
            checks.push_back(
                criterion("F_N(0) [N], planar", F_N_at_start(benchmarks[k]), 9.155246512774925, 1e-11));
        if (s.name == "xy")
            checks.push_back(
                criterion("F_N(0) [N], xy", F_N_at_start(benchmarks[k]), 9.014262047215154, 1e-11));
        if (s.name == "planar-roll")
            checks.push_back(criterion("friction at release [N], planar-roll",
                                       friction_at_start(benchmarks[k]), 1.006816007361521, 1e-11));
    }
}

/// The loop passes n_z = 0. The run with tangent rows must reach the end. The run with rows along the global
/// x and y must fail before it, because those rows are singular there.
void check_loop(const BowlRun& run, std::vector<Criterion>& checks)
{
    const std::string suffix = ", loop by " + run.label();
    double least = 1, most = -1;
    for (const BowlSample& s : run.sample) least = std::min(least, s[n_z]), most = std::max(most, s[n_z]);
    if (run.rows == "tangent") {
        checks.push_back(between("time reached [s]" + suffix,
                                 run.failed() ? std::nan("") : run.sample.back()[t], run.c->end - 1e-9,
                                 run.c->end + run.h));
        checks.push_back(between("least n_z" + suffix, least, -1, -0.99));
        checks.push_back(between("largest n_z" + suffix, most, 0.99, 1));
        checks.push_back(between("residual of Psi, N, G [m]" + suffix,
                                 std::max({run.largest(Psi), run.largest(N), run.largest(G)}), 0, 1e-12));
    } else {
        checks.push_back(between("last node before the failure [s]" + suffix,
                                 run.failed() ? run.sample.back()[t] : run.c->end, 0, 0.99 * run.c->end));
    }
}

std::string curves(const std::vector<const BowlRun*>& runs)
{
    std::string csv = "run,h";
    for (const char* column : columns) csv += std::string(",") + column;
    csv += '\n';
    for (const BowlRun* run : runs) {
        const size_t stride = std::max<size_t>(1, (run->sample.size() + max_rows - 1) / max_rows);
        for (size_t k = 0; k < run->sample.size(); k += stride) {
            csv += io::csv_field(run->label()) + ',';
            io::append_number(csv, run->h);
            for (const double value : run->sample[k]) {
                csv += ',';
                if (!std::isnan(value)) io::append_number(csv, value);
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
        table.add({run.variant->name, run.scheme->name, run.rows, run.h, run.error[norm::r],
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
    out << fmt::format("\n{}: ball in a bowl, {}; reference solution: {}\n", s.name, s.what,
                       runs.front()->c->reference_name);
    table.print(out);
}

std::vector<const BowlVariant*> selected_variants(const StudyOptions& options)
{
    std::vector<std::string> known;
    for (const BowlVariant& s : variants) known.push_back(s.name);
    for (const std::string& name : options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw io::UsageError("study " + kind + ": unknown scene" + with_nearest(name, known));
    std::vector<const BowlVariant*> selected;
    for (const BowlVariant& s : variants)
        if (options.problems.empty() ||
            std::find(options.problems.begin(), options.problems.end(), s.name) != options.problems.end())
            selected.push_back(&s);
    return selected;
}

/// The changes of the variant are written into the model text, so that the reference solution has them as
/// well.
Benchmark benchmark_of(const BowlVariant& s, const StudyOptions& options, const std::string& rows)
{
    Problem p = problem(s.problem);
    p.model = dae::read_model(p.model, p.name, normal_rows(s.problem, s.set, rows)).text;
    return make_benchmark(std::move(p), options, [&](const dae::Description&) { return s.end; });
}

int study(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"r", "alpha", "F_N", "energy"});
    check_vtk(kind, options);
    const double h = one_step(kind, options, default_step);
    const Schemes schemes = fixed_step_schemes(kind, options, {dissertation_scheme, recommended_scheme});
    const std::string rows = options.normal_rows.empty() ? "tangent" : options.normal_rows;
    const std::vector<const BowlVariant*> selected = selected_variants(options);
    Evaluated evaluated{.smallest_step = h};
    for (const lie::Scheme* s : schemes)
        evaluated.highest_order = std::max(evaluated.highest_order, s->order);
    const Reference reference(kind, options, evaluated);
    std::vector<Benchmark> benchmarks, fixed_xy;  // fixed_xy: the loop with rows along x and y
    for (const BowlVariant* s : selected) {
        benchmarks.push_back(benchmark_of(*s, options, rows));
        check_steps(kind, benchmarks.back(), {h},
                    benchmarks.back().instants.dt * benchmarks.back().instants.stride);
        if (s->loop && options.normal_rows.empty()) fixed_xy.push_back(benchmark_of(*s, options, "fixed-xy"));
    }
    reference.evaluate(benchmarks);
    for (Benchmark& c : fixed_xy)
        for (size_t k = 0; k < selected.size(); ++k)
            if (selected[k]->loop) c.reference_solution = benchmarks[k].reference_solution;

    std::vector<BowlRun> runs;
    const auto add = [&](const Benchmark& c, const BowlVariant& s, const lie::Scheme& scheme,
                         const std::string& normal_rows_of_run, double step, bool for_check) {
        BowlRun run;
        run.c = &c, run.scheme = &scheme, run.h = step;
        run.variant = &s, run.rows = normal_rows_of_run, run.for_check = for_check;
        runs.push_back(std::move(run));
    };
    for (size_t k = 0; k < selected.size(); ++k)
        for (const lie::Scheme* scheme : schemes) {
            add(benchmarks[k], *selected[k], *scheme, rows, h, false);
            if (options.check && !selected[k]->loop)
                add(benchmarks[k], *selected[k], *scheme, rows, h / 2, true);
            for (const Benchmark& c : fixed_xy)
                if (selected[k]->loop) add(c, *selected[k], *scheme, "fixed-xy", h, false);
        }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    StudyOutput output{.kind = kind, .table = as_table(runs).csv()};
    std::vector<Criterion> checks;
    check_initial_forces(benchmarks, selected, checks);
    std::vector<Measured> measurements;
    std::vector<const Run*> expected_to_finish;  // without the runs that are expected to fail
    for (const BowlVariant* s : selected) {
        std::vector<const BowlRun*> shown, drawn;
        for (const BowlRun& run : runs) {
            if (run.variant != s) continue;
            shown.push_back(&run);
            if (!run.for_check) drawn.push_back(&run);
            if (run.rows == rows) expected_to_finish.push_back(&run);
            if (s->loop) check_loop(run, checks);
            if (run.for_check || s->loop) continue;
            const auto half = std::find_if(runs.begin(), runs.end(), [&](const BowlRun& other) {
                return other.for_check && other.variant == s && other.scheme == run.scheme;
            });
            check_run(run, half == runs.end() ? nullptr : &*half, checks);
            measurements.push_back({.of = run.label() + " on " + s->name,
                                    .value = {{"r", run.error[norm::r]},
                                              {"alpha", run.error[norm::alpha]},
                                              {"F_N", run.error[norm::F_N]},
                                              {"energy", run.largest(energy)}}});
        }
        print(shown, *s, output.text);
        output.files.emplace_back(s->name + ".csv", curves(drawn));
        output.figures.push_back(kind + '-' + s->name + ".png");
    }
    const bool passed = evaluate(checks, output.text, output.json);
    if (!options.check)
        output.text << "--check adds runs with half of the step and evaluates all acceptance criteria\n";
    const int code = finish(options, output, expected_to_finish, measurements);
    return code == io::exit_code::done && options.check && !passed ? io::exit_code::expectation_failed : code;
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "ball in an ellipsoidal bowl, contact points as unknowns: forces, "
                                    "residuals and energy (Figs. 5.2-5.6)",
                         .accepted = takes::reference | takes::check | takes::vtk | takes::normal_rows,
                         .run = study});

}  // namespace

}  // namespace hilda::studies
