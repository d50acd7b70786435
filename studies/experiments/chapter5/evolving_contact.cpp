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

#include "studies/experiments/chapter5/evolving_errors.hpp"
#include "studies/experiments/chapter5/model_with_frames.hpp"
#include "studies/framework/reference_solution.hpp"
#include "studies/framework/sweep.hpp"
#include "studies/running/model_frames.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using contact::EvolvingContact;
namespace norm = evolving_norm;

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
constexpr std::array<const char*, sample_size> quantities = {
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
    double residual() const { return std::max({largest(Psi), largest(N), largest(G)}); }
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
    const std::string name =
        run.variant->name + '-' + run.scheme->name + (run.rows == "tangent" ? "" : '-' + run.rows);
    march_with_frames(run, options, 1e-14, {&sampler, &comparison}, name, !run.for_check);
    run.error = comparison.error;
    if (run.failed()) run.error.fill(std::nan(""));
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

EvolvingContact::Multipliers forces_at_start(const Benchmark& c)
{
    const dae::Model& model = *c.started->model;
    const EvolvingContact& contact = *evolving_contacts(model).front();
    return contact.multipliers(model.arguments(contact, c.started->x), c.started->x.lambda);
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
    checks.push_back(between("residual of Psi, N, G [m]" + suffix, run.residual(), 0, 8e-15));
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
            checks.push_back(criterion("F_N(0) [N], planar", forces_at_start(benchmarks[k]).F_N,
                                       9.155246512774925, 1e-11));
        if (s.name == "xy")
            checks.push_back(
                criterion("F_N(0) [N], xy", forces_at_start(benchmarks[k]).F_N, 9.014262047215154, 1e-11));
        if (s.name == "planar-roll")
            checks.push_back(criterion("friction at release [N], planar-roll",
                                       forces_at_start(benchmarks[k]).friction.norm(), 1.006816007361521,
                                       1e-11));
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
        checks.push_back(between("residual of Psi, N, G [m]" + suffix, run.residual(), 0, 1e-12));
    } else {
        checks.push_back(between("last node before the failure [s]" + suffix,
                                 run.failed() ? run.sample.back()[t] : run.c->end, 0, 0.99 * run.c->end));
    }
}

std::string curves(const std::vector<const BowlRun*>& runs)
{
    std::vector<Table::Column> titles = {{"run"}, {"h"}};
    for (const char* name : quantities) titles.push_back({name});
    Table table(titles);
    for (const BowlRun* run : runs) {
        const size_t stride = std::max<size_t>(1, (run->sample.size() + max_rows - 1) / max_rows);
        for (size_t k = 0; k < run->sample.size(); k += stride) {
            std::vector<Table::Cell> row = {run->label(), run->h};
            row.insert(row.end(), run->sample[k].begin(), run->sample[k].end());
            table.add(row);
        }
    }
    return table.csv();
}

Column<BowlRun> error(const std::string& heading, int n)
{
    return {std::string("error_") + norm::names[n], heading, "{:.2e}",
            [n](const BowlRun& run) { return run.error[n]; }};
}
Column<BowlRun> largest(const std::string& name, int quantity)
{
    return {name, [=](const BowlRun& run) { return run.largest(quantity); }};
}

/// Columns of the runs; the heading of the first names the variant.
Columns<BowlRun> columns_of(const std::string& variant = "run")
{
    return {{"scene", [](const BowlRun& run) { return run.variant->name; }},
            {"", variant, &BowlRun::label},
            Column<BowlRun>(column::integrator).as(""),
            {"rows", &BowlRun::rows},
            Column<BowlRun>(column::h).as("h [s]", "{:.2e}"),
            error("r [m]", norm::r),
            error("alpha [m]", norm::alpha),
            error("F_N [N]", norm::F_N),
            largest("Psi", Psi),
            largest("N", N),
            largest("G", G),
            {"", "Psi, N, G [m]", "{:.1e}", &BowlRun::residual},
            {"", "lambda_N, _t [N]", "{:.1e}",
             [](const BowlRun& run) { return std::max(run.largest(lambda_N), run.largest(lambda_t)); }},
            largest("lambda_N", lambda_N),
            largest("lambda_t", lambda_t),
            largest("energy_change", energy).as("E-E0 [J]", "{:.1e}"),
            largest("F_N_most", F_N),
            column::iterations,
            column::cpu_seconds,
            column::status};
}

/// The changes of the variant are written into the model text, so that the reference solution has them as
/// well.
Benchmark benchmark_of(const BowlVariant& s, const StudyOptions& options, const std::string& rows)
{
    Problem p = problem(s.problem);
    p.model = dae::read_model(p.model, p.name, s.set, rows).text;
    return make_benchmark(std::move(p), options, [&](const dae::Description&) { return s.end; });
}

void evolving_contact(StudyContext& s)
{
    const StudyOptions& options = s.options;
    const double h = s.one_step(default_step);
    const Schemes schemes = s.fixed_step_schemes({dissertation_scheme, recommended_scheme});
    const std::string rows = options.normal_rows.empty() ? "tangent" : options.normal_rows;
    const std::vector<const BowlVariant*> selected = selected_parts(s, "scene", variants);
    const Reference reference(s, finest(schemes, h));
    std::vector<Benchmark> benchmarks, fixed_xy;  // fixed_xy: the loop with rows along x and y
    for (const BowlVariant* variant : selected) {
        benchmarks.push_back(benchmark_of(*variant, options, rows));
        if (variant->loop && options.normal_rows.empty())
            fixed_xy.push_back(benchmark_of(*variant, options, "fixed-xy"));
    }
    reference.evaluate(benchmarks, {h});
    for (Benchmark& c : fixed_xy)
        for (size_t k = 0; k < selected.size(); ++k)
            if (selected[k]->loop) c.reference_solution = benchmarks[k].reference_solution;

    Sweep<BowlRun> runs;
    const auto add = [&](const Benchmark& c, const BowlVariant& variant, const lie::Scheme& scheme,
                         const std::string& normal_rows_of_run, double step, bool for_check) {
        BowlRun& run = runs.add(c, scheme, step);
        run.variant = &variant, run.rows = normal_rows_of_run, run.for_check = for_check;
    };
    for (size_t k = 0; k < selected.size(); ++k)
        for (const lie::Scheme* scheme : schemes) {
            add(benchmarks[k], *selected[k], *scheme, rows, h, false);
            if (options.check && !selected[k]->loop)
                add(benchmarks[k], *selected[k], *scheme, rows, h / 2, true);
            for (const Benchmark& c : fixed_xy)
                if (selected[k]->loop) add(c, *selected[k], *scheme, "fixed-xy", h, false);
        }
    runs.compute(s, [&](BowlRun& run) { compute(run, options); });

    std::vector<Criterion> checks;
    check_initial_forces(benchmarks, selected, checks);
    std::vector<const Run*> expected_to_finish;  // without the runs that are expected to fail
    for (const BowlVariant* variant : selected) {
        const auto shown = those(runs, [&](const BowlRun& run) { return run.variant == variant; });
        std::vector<const BowlRun*> drawn;
        for (const BowlRun* run : shown) {
            if (!run->for_check) drawn.push_back(run);
            if (run->rows == rows) expected_to_finish.push_back(run);
            if (variant->loop) check_loop(*run, checks);
            if (run->for_check || variant->loop) continue;
            const auto half = those(runs, [&](const BowlRun& other) {
                return other.for_check && other.variant == variant && other.scheme == run->scheme;
            });
            check_run(*run, half.empty() ? nullptr : half.front(), checks);
            s.measured.push_back({.of = run->label() + " on " + variant->name,
                                  .value = {{"r", run->error[norm::r]},
                                            {"alpha", run->error[norm::alpha]},
                                            {"F_N", run->error[norm::F_N]},
                                            {"energy", run->largest(energy)}}});
        }
        s.text << fmt::format("\n{}: ball in a bowl, {}; reference solution: {}\n", variant->name,
                              variant->what, shown.front()->c->reference_name);
        columns_of(variant->name).print(s.text, shown);
        s.files.emplace_back(variant->name + ".csv", curves(drawn));
        s.figures.push_back(s.name + '-' + variant->name + ".png");
    }
    s.evaluate(checks);
    if (!options.check)
        s.text << "--check adds runs with half of the step and evaluates all acceptance criteria\n";
    s.table = columns_of().csv(runs);
    s.end_of_runs(expected_to_finish);
}

const bool registered =
    io::Registry<Study>::add({.name = "evolving-contact",
                              .answers = "ball in an ellipsoidal bowl, contact points as unknowns: forces, "
                                         "residuals and energy (Figs. 5.2-5.6)",
                              .accepted = takes::reference | takes::check | takes::vtk | takes::normal_rows,
                              .keys = {"r", "alpha", "F_N", "energy"},
                              .run = evolving_contact});

}  // namespace

}  // namespace hilda::studies
