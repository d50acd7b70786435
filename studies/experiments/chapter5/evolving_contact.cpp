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
#include "studies/experiments/chapter5/recorded_run.hpp"
#include "studies/framework/reference_solution.hpp"

#include "dae/model.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using contact::EvolvingContact;
namespace norm = evolving_norm;

constexpr size_t max_rows = 2000;  // limit on the rows per run in SCENE.csv
constexpr double default_step = 5e-3, default_end = 10;

/// A scene with its closed forms and the largest accepted errors at the default step
struct BowlVariant {
    std::string name, problem, what;
    std::vector<std::string> set = {};
    double end = default_end;
    bool rolls = false, loop = false;
    double force_at_start = std::nan("");  ///< normal force, of a rolling ball the friction [N]
    /// Errors of position [m] and normal force [N], with rA-half-1 and with rA-half-1-momentum
    std::array<std::array<double, 2>, 2> bounds = {};
    double energy = 0;  ///< change of energy [J]; 0: no criterion
    /// Planar motion: normal force [N] and speed [m/s] at the bottom, period [s]; 0: no closed form
    double F_N = 0, speed = 0, period = 0;
};

const std::vector<BowlVariant> variants = {
    {.name = "planar",
     .problem = "ball_in_bowl",
     .what = "released at (0, 1.5), frictionless",
     .force_at_start = 9.155246512774925,
     .bounds = {{{6e-3, 7.8e-3}, {7e-5, 9.5e-5}}},
     .energy = 4e-5,
     .F_N = 10.960602417068388,
     .speed = 2.145322742217019,
     .period = 3.918321172588791},
    {.name = "xy",
     .problem = "ball_in_bowl_xy",
     .what = "released at (1, 1.5), frictionless",
     .force_at_start = 9.014262047215154,
     .bounds = {{{6.4e-3, 9e-3}, {7e-5, 1e-4}}}},
    {.name = "planar-roll",
     .problem = "rolling_ball_in_bowl",
     .what = "released at (0, 1.5), rolling",
     .rolls = true,
     .force_at_start = 1.006816007361521,
     .F_N = 10.631858869334563,
     .speed = 1.8131286433505626,
     .period = 4.636220134568755},
    {.name = "xy-roll",
     .problem = "rolling_ball_in_bowl_xy",
     .what = "released at (1, 1.5), rolling",
     .rolls = true},
    {.name = "loop",
     .problem = "ball_in_bowl",
     .what = "started at the bottom with 14 m/s, around the whole ellipsoid",
     .set = {"/bodies/0/r=[0, 0, -1.5]", "/bodies/0/r_dot=[0, 14, 0]"},
     .end = 3,
     .loop = true}};

/// Quantities recorded at every node, columns of SCENE.csv
const std::vector<std::string> quantities = {
    "t", "aj_x", "aj_y",     "aj_z",     "ai_x",     "ai_y",          "ai_z", "Psi",   "N",
    "G", "F_N",  "lambda_N", "lambda_t", "friction", "energy_change", "y",    "speed", "n_z"};

struct BowlRun : RecordedRun<BowlVariant> {
    std::string rows;
    std::array<double, norm::count> error{};

    void transfer(io::Archive& a)
    {
        RecordedRun::transfer(a);
        a.value(error);
    }
    std::string label() const { return scheme->name + (rows == "tangent" ? "" : ", " + rows); }
    double residual() const
    {
        return std::max({curve.largest("Psi"), curve.largest("N"), curve.largest("G")});
    }
};

/// Integrates and records every node.
///
/// rA-half-1 stores the velocities of the middle of the step (v_{n-1/2}). The energy at a node is then
/// computed with the mean of the velocities before and after it, so it is available one step later.
void compute(BowlRun& run, const StudyOptions& options)
{
    const dae::Model& model = *run.c->started->model;
    const EvolvingContact& contact = *run::evolving_contacts(model).front();
    const double initial_energy = lie::energy(model, run.c->started->x);
    const bool half_step_velocities = run.which_scheme() == 0;
    lie::State last;
    Curve& curve = run.curve = Curve(quantities);
    AtNodes sampler([&](const lie::State& x) {
        const dae::Constraint::Arguments at = model.arguments(contact, x);
        const EvolvingContact::Multipliers multipliers = contact.multipliers(at, x.lambda);
        double Phi[7];
        contact.phi(at, Phi);
        double energy = lie::energy(model, x) - initial_energy;
        if (half_step_velocities) {
            if (const size_t rows = curve.rows(); rows > 0) {
                last.body[0].rdot = 0.5 * (last.body[0].rdot + x.body[0].rdot);
                last.body[0].omega_bar = 0.5 * (last.body[0].omega_bar + x.body[0].omega_bar);
                curve.at(rows - 1, "energy_change") = lie::energy(model, last) - initial_energy;
                curve.at(rows - 1, "speed") = last.body[0].rdot.norm();
            }
            energy = std::nan("");  // set when the next node is available
            last = x;
        }
        const auto& a = x.alpha;
        curve.add({x.t, a[3], a[4], a[5], a[0], a[1], a[2], lie::Vec3::Map(Phi).norm(),
                   std::hypot(Phi[3], Phi[4]), std::hypot(Phi[5], Phi[6]), multipliers.F_N,
                   multipliers.N.norm(), multipliers.tangential.norm(), multipliers.friction.norm(), energy,
                   x.body[0].r.y(), x.body[0].rdot.norm(), contact.contact_point(at).n.z()});
    });
    ReferenceErrors comparison(*run.c, run.h);
    const std::string name =
        run.variant->name + '-' + run.scheme->name + (run.rows == "tangent" ? "" : '-' + run.rows);
    march_with_frames(run, options, 1e-14, {&sampler, &comparison}, name);
    run.error = comparison.error;
    if (run.failed()) run.error.fill(std::nan(""));
}

/// Maximum of a recorded quantity, from a parabola through the largest sample and its two neighbours
double peak(const BowlRun& run, const std::string& quantity)
{
    const Curve& c = run.curve;
    size_t k = 0;
    for (size_t i = 1; i < c.rows(); ++i)
        if (c.at(i, quantity) > c.at(k, quantity)) k = i;
    if (k == 0 || k + 1 >= c.rows()) return c.rows() == 0 ? std::nan("") : c.at(k, quantity);
    return c.extremum(k, quantity, run.h).value;
}

/// Mean period [s], from the first to the last downward crossing of y = 0
double period(const BowlRun& run)
{
    const std::vector<double> down = run.curve.zero_crossings("y");
    return down.size() < 2 ? std::nan("")
                           : (down.back() - down.front()) / static_cast<double>(down.size() - 1);
}

void check_start(const Benchmark& c, const BowlVariant& v, std::vector<Criterion>& checks)
{
    const dae::Model& model = *c.started->model;
    const EvolvingContact::Multipliers start =
        run::forces(model, *run::evolving_contacts(model).front(), c.started->x);
    if (!std::isnan(v.force_at_start))
        checks.push_back(criterion((v.rolls ? "friction at release [N], " : "F_N(0) [N], ") + v.name,
                                   v.rolls ? start.friction.norm() : start.F_N, v.force_at_start, 1e-11));
}

void check_run(const BowlRun& run, const BowlRun* half, std::vector<Criterion>& list)
{
    const BowlVariant& v = *run.variant;
    const Curve& curve = run.curve;
    CriteriaOf checks{", " + v.name + " by " + run.label(), list};
    const double F = curve.largest("F_N");
    checks.between("residual of Psi, N, G [m]", run.residual(), 0, 8e-15);
    checks.between("|lambda_N| over F_N", curve.largest("lambda_N") / F, 0, 1e-12);
    checks.between("tangential part of lambda over F_N", curve.largest("lambda_t") / F, 0, 1e-12);
    const size_t scheme = run.which_scheme();
    if (run.h != default_step || run.c->end != default_end || scheme > 1) return;
    const double change = curve.largest("energy_change");
    if (!v.rolls) {
        checks.between("error of position [m]", run.error[norm::r], 0, v.bounds[scheme][0]);
        checks.between("error of the normal force [N]", run.error[norm::F_N], 0, v.bounds[scheme][1]);
        if (v.energy > 0) checks.between("change of energy [J]", change, 0, v.energy);
        if (half != nullptr)
            checks.equals("change of energy over that with half of the step",
                          change / half->curve.largest("energy_change"), 4, 0.2);
    }
    if (half != nullptr)
        checks.equals("order of position", std::log2(run.error[norm::r] / half->error[norm::r]),
                      scheme == 0 ? 1 : 2, 0.03);
    if (v.period == 0) return;
    const double tolerance = scheme == 0 ? 5e-3 : 1e-4;
    checks.equals("F_N at the bottom [N]", peak(run, "F_N"), v.F_N, tolerance);
    checks.equals("speed at the bottom [m/s]", peak(run, "speed"), v.speed, tolerance);
    checks.equals("period [s]", period(run), v.period, tolerance);
}

/// The loop passes n_z = 0. The run with tangent rows must reach the end. The run with rows along the global
/// x and y must fail before it, because those rows are singular there.
void check_loop(const BowlRun& run, std::vector<Criterion>& list)
{
    CriteriaOf checks{", loop by " + run.label(), list};
    double least = 1, most = -1;
    for (size_t k = 0; k < run.curve.rows(); ++k)
        least = std::min(least, run.curve.at(k, "n_z")), most = std::max(most, run.curve.at(k, "n_z"));
    const double end = run.c->end, reached = run.curve.last("t");
    if (run.rows == "tangent") {
        checks.between("time reached [s]", run.failed() ? std::nan("") : reached, end - 1e-9, end + run.h);
        checks.between("least n_z", least, -1, -0.99);
        checks.between("largest n_z", most, 0.99, 1);
        checks.between("residual of Psi, N, G [m]", run.residual(), 0, 1e-12);
    } else {
        checks.between("last node before the failure [s]", run.failed() ? reached : end, 0, 0.99 * end);
    }
}

Column<BowlRun> error(const std::string& heading, int n)
{
    return {std::string("error_") + norm::names[n], heading, "{:.2e}",
            [n](const BowlRun& run) { return run.error[n]; }};
}
Column<BowlRun> largest(const std::string& name, const std::string& quantity)
{
    return {name, [=](const BowlRun& run) { return run.curve.largest(quantity); }};
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
            largest("Psi", "Psi"),
            largest("N", "N"),
            largest("G", "G"),
            {"", "Psi, N, G [m]", "{:.1e}", &BowlRun::residual},
            {"", "lambda_N, _t [N]", "{:.1e}",
             [](const BowlRun& run) {
                 return std::max(run.curve.largest("lambda_N"), run.curve.largest("lambda_t"));
             }},
            largest("lambda_N", "lambda_N"),
            largest("lambda_t", "lambda_t"),
            largest("energy_change", "energy_change").as("E-E0 [J]", "{:.1e}"),
            largest("F_N_most", "F_N"),
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
    std::vector<Benchmark> benchmarks;
    for (const BowlVariant* variant : selected) benchmarks.push_back(benchmark_of(*variant, options, rows));
    reference.evaluate(benchmarks, {h});

    Sweep<BowlRun> runs;
    const auto add = [&](const Benchmark& c, const BowlVariant& variant, const lie::Scheme& scheme,
                         const std::string& normal_rows, double step, bool for_check) {
        BowlRun& run = runs.add(c, scheme, step);
        run.variant = &variant, run.rows = normal_rows, run.for_check = for_check;
    };
    Benchmark fixed_xy;  // the loop with rows along x and y, compared with the same reference solution
    std::vector<Criterion> checks;
    for (size_t k = 0; k < selected.size(); ++k) {
        const BowlVariant& variant = *selected[k];
        check_start(benchmarks[k], variant, checks);
        const bool with_fixed_xy = variant.loop && options.normal_rows.empty();
        if (with_fixed_xy) {
            fixed_xy = benchmark_of(variant, options, "fixed-xy");
            fixed_xy.reference_solution = benchmarks[k].reference_solution;
        }
        for (const lie::Scheme* scheme : schemes) {
            add(benchmarks[k], variant, *scheme, rows, h, false);
            if (options.check && !variant.loop) add(benchmarks[k], variant, *scheme, rows, h / 2, true);
            if (with_fixed_xy) add(fixed_xy, variant, *scheme, "fixed-xy", h, false);
        }
    }
    runs.compute(s, [&](BowlRun& run) { compute(run, options); });

    std::vector<const Run*> expected_to_finish;  // without the runs that are expected to fail
    for (const BowlVariant* variant : selected) {
        const auto shown = those(runs, [&](const BowlRun& run) { return run.variant == variant; });
        CurveTable curves({"run", "h"}, quantities);
        for (const BowlRun* run : shown) {
            if (run->rows == rows) expected_to_finish.push_back(run);
            if (run->for_check) continue;
            curves.add({run->label(), run->h}, run->curve, max_rows);
            if (variant->loop) {
                check_loop(*run, checks);
                continue;
            }
            check_run(*run, half_step_run(runs, *run), checks);
            s.measure(run->label() + " on " + variant->name,
                      {{"r", run->error[norm::r]},
                       {"alpha", run->error[norm::alpha]},
                       {"F_N", run->error[norm::F_N]},
                       {"energy", run->curve.largest("energy_change")}});
        }
        s.text << fmt::format("\n{}: ball in a bowl, {}; reference solution: {}\n", variant->name,
                              variant->what, shown.front()->c->reference_name);
        columns_of(variant->name).print(s.text, shown);
        s.files.emplace_back(variant->name + ".csv", curves.csv());
        s.figures.push_back(s.name + '-' + variant->name + ".png");
    }
    s.evaluate(checks);
    if (!options.check)
        s.text << "--check adds runs with half of the step and evaluates all acceptance criteria\n";
    s.table = columns_of().csv(runs);
    s.end_of_runs(expected_to_finish);
}

const bool registered_evolving_contact = io::Registry<Study>::add(
    {.name = "evolving-contact",
     .answers = "ball in an ellipsoidal bowl, contact points as unknowns: forces, "
                "residuals and energy (Figs. 5.2-5.6)",
     .options =
         options_of_models({"--reference", "--check", "--vtk", "--normal-rows", "--strict", "--shard"}),
     .keys = {"r", "alpha", "F_N", "energy"},
     .files = {"SCENE.csv", "evolving-contact-SCENE.png"},
     .run = evolving_contact});

}  // namespace

}  // namespace hilda::studies
