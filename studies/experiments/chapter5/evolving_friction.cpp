// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball in an ellipsoidal bowl with friction and rolling resistance (Fang 2022, Sec. 5.5.2, Table 5.1,
/// Figs. 5.7, 5.8).
///
/// The contact points are unknowns. The friction law of Chapter 4 is evaluated on the displacements of the
/// contact point over both bodies. The ball is released from rest at the contact point (0, 1.5) with rolling
/// resistance η_r = 0, 0.1, 0.2 and 0.3. curves.csv contains, at every node, the contact point, the forces,
/// the rolling torque and the speeds, and the same quantities of the ideal limit (rolling without slip,
/// resistance without a spring). The results are compared with reference values. --check adds a run with half
/// of the step for η_r = 0 and returns exit code 6 if an acceptance criterion fails.
///
/// The step of the dissertation, 5e-3 s, is above 4.64e-3 s, the stability limit of the friction springs of a
/// homogeneous ball. The default step is therefore 2.5e-3 s.

#include "run/columns/contact_outputs.hpp"
#include "run/diagnosis.hpp"
#include "studies/experiments/chapter5/recorded_run.hpp"

#include "dae/model.hpp"
#include "reference/motions/planar_bowl.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using reference::ContactInstant;
using reference::PlanarBowl;

constexpr double friction_step = 2.5e-3, friction_end = 10;
constexpr double y_start = 1.5;       // y of the contact point at the start [m]
constexpr double transient = 0.1;     // duration of the transient after the release [s]
constexpr double comparison_end = 3;  // end of the comparison with the one-angle equation [s]
constexpr size_t ideal_rows = 1001;   // rows of an ideal limit in curves.csv

/// A run of the dissertation with its reference values: reversals and stop time of the ideal limit, rest
/// position of the model with friction springs
struct BrakedVariant {
    std::string name;
    double eta_r;
    double y_rest = std::nan("");        ///< y of the contact point at rest [m]
    double stop_time = std::nan("");     ///< [s]
    std::vector<double> reversals = {};  ///< y of the contact point at the reversals of motion [m]
};
const std::vector<BrakedVariant> braked_variants = {
    {.name = "eta-0", .eta_r = 0},
    {.name = "eta-0.1",
     .eta_r = 0.1,
     .y_rest = -0.0929,
     .stop_time = 9.406,
     .reversals = {-1.1110, 0.7137, -0.3114}},
    {.name = "eta-0.2", .eta_r = 0.2, .y_rest = -0.0859, .stop_time = 4.675, .reversals = {-0.7170}},
    {.name = "eta-0.3", .eta_r = 0.3, .y_rest = -0.3250, .stop_time = 2.309}};

/// Quantities recorded at every node, columns of curves.csv
const std::vector<std::string> braked_quantities = {"t", "y", "z", "F_N", "F_f", "torque", "v", "omega"};

struct BrakedRun : RecordedRun<BrakedVariant> {
    std::vector<lie::Vec3> r;  ///< centre of the ball, for the comparison with the one-angle equation

    double bound = 0;  ///< largest stable step [s]
    /// Errors relative to the one-angle equation [m, N]: largest error of r, error of r at the last instant,
    /// largest error of the friction. The order of r is measured at the last instant, because during the
    /// transient of the release the friction of the previous step causes an error of first order.
    double error_r = std::nan(""), error_r_last = std::nan(""), error_F_f = std::nan("");

    void transfer(io::Archive& a)
    {
        RecordedRun::transfer(a);
        a.list(r), a.value(bound), a.value(error_r), a.value(error_r_last), a.value(error_F_f);
    }

    double max_friction() const { return failed() ? std::nan("") : curve.largest("F_f", transient); }
    /// Reversals of motion: extrema of y [m]
    std::vector<Curve::Extremum> reversals() const
    {
        std::vector<Curve::Extremum> all;
        for (size_t k = 2; k < curve.rows(); ++k) {
            const double a = curve.at(k - 2, "y"), b = curve.at(k - 1, "y"), c = curve.at(k, "y");
            if ((c - b) * (b - a) < 0 && std::abs(c - y_start) >= 0.1)
                all.push_back(curve.extremum(k - 1, "y", h));
        }
        return all;
    }
    double y_at_end() const { return failed() ? std::nan("") : curve.last("y"); }
    /// The first reversal after those of the variant: the ball does not start again from there.
    double stop_time() const
    {
        const std::vector<Curve::Extremum> all = reversals();
        return variant->eta_r > 0 && all.size() > variant->reversals.size() ? all[variant->reversals.size()].t
                                                                            : std::nan("");
    }
};

/// Without rolling resistance the motion follows one equation in one angle with a smooth friction force.
void compare_with_reference(BrakedRun& run)
{
    if (run.variant->eta_r != 0 || run.failed()) return;
    std::vector<double> instants;
    for (size_t k = 0; k < run.r.size(); ++k) instants.push_back(run.curve.t(k));
    const std::vector<ContactInstant> reference_solution = PlanarBowl{}.spring({.y = y_start}, {}, instants);
    run.error_r = run.error_F_f = 0;
    for (size_t k = 0; k < reference_solution.size(); ++k) {
        run.error_r_last = (run.r[k] - reference_solution[k].body.r).norm();
        run.error_r = std::max(run.error_r, run.error_r_last);
        if (instants[k] > transient)
            run.error_F_f =
                std::max(run.error_F_f, std::abs(run.curve.at(k, "F_f") - reference_solution[k].F_t.norm()));
    }
}

void compute(BrakedRun& run, const StudyOptions& options)
{
    const dae::Model& model = *run.c->started->model;
    const run::ContactOutputs outputs(model);
    const run::ContactOutputs::Contact& braked =
        *std::find_if(outputs.contacts.begin(), outputs.contacts.end(),
                      [](const run::ContactOutputs::Contact& c) { return c.friction != nullptr; });
    const contact::EvolvingContact& contact = *braked.constraint;
    const contact::EvolvingFriction& friction = *braked.friction;
    run.bound = model.stable_step(run.c->started->x).h;
    run.curve = Curve(braked_quantities);
    AtNodes sampler([&](const lie::State& x) {
        const lie::Motion& ball = x.body[0];
        const contact::Wrench by = friction.friction(x);
        const lie::Vec3 p = lie::Vec3::Map(x.alpha.data() + 3);
        run.curve.add({x.t, p.y(), p.z(), run::forces(model, contact, x).F_N, by.F.norm(), by.T_i.norm(),
                       ball.rdot.norm(), ball.omega_bar.norm()});
        if (run.variant->eta_r == 0 && x.t <= comparison_end) run.r.push_back(ball.r);
    });
    const std::string name =
        fmt::format("{}-{}-{}", run.variant->name, run.scheme->name, run::step_text(run.h));
    march_with_frames(run, options, 1e-13, {&sampler}, name);  // below the errors in the table
    if (options.set.empty()) compare_with_reference(run);
}

void check_run(const BrakedRun& run, const BrakedRun* half, std::vector<Criterion>& list)
{
    const BrakedVariant& v = *run.variant;
    CriteriaOf checks{fmt::format(", {} by {} at {} s", v.name, run.scheme->name, run::step_text(run.h)),
                      list};
    const size_t scheme = run.which_scheme();
    if (v.eta_r == 0) {
        checks.equals("largest friction after 0.1 s [N]", run.max_friction(), 1.007, 5e-3);
        checks.between("error of the friction relative to the one-angle equation [N]", run.error_F_f, 0,
                       scheme == 0 ? 1e-2 : 5e-3);
        if (run.h != friction_step || scheme > 1) return;
        if (scheme == 0)
            checks.equals("error of position, 3 s [m]", run.error_r, 2.3e-3, 1e-4);
        else
            checks.between("error of position, 3 s [m]", run.error_r, 0, 3e-6);
        if (half != nullptr)
            checks.equals("order of position at 3 s", std::log2(run.error_r_last / half->error_r_last),
                          scheme == 0 ? 1 : 2, 0.05);
        return;
    }
    checks.equals("y at rest [m]", run.y_at_end(), v.y_rest, 1e-3);
    checks.equals("stop time [s]", run.stop_time(), v.stop_time, 0.03);
    checks.between("speed at the end [m/s]", run.failed() ? std::nan("") : run.curve.last("v"), 0, 1e-4);
    const std::vector<Curve::Extremum> reversals = run.reversals();
    for (size_t k = 0; k < v.reversals.size(); ++k)
        checks.equals(fmt::format("reversal {} at y [m]", k + 1),
                      k < reversals.size() ? reversals[k].value : std::nan(""), v.reversals[k], 1e-3);
}

/// Ideal limit: rolling without slip, the rolling resistance has its kinetic value as soon as the ball rolls
Curve ideal(const BrakedVariant& variant, double end)
{
    std::vector<double> instants;
    for (size_t k = 0; k < ideal_rows; ++k)
        instants.push_back(end * static_cast<double>(k) / static_cast<double>(ideal_rows - 1));
    Curve curve(braked_quantities);
    for (const ContactInstant& at :
         PlanarBowl{}.resist({.y = y_start}, {.eta = variant.eta_r}, instants).instant)
        curve.add({at.t, at.p.y(), at.p.z(), at.F_N, at.F_t.norm(), at.moment.norm(), at.body.rdot.norm(),
                   at.body.omega_bar.norm()});
    return curve;
}

const Columns<BrakedRun> columns = {
    {"eta_r", "eta_r", "{:g}", [](const BrakedRun& run) { return run.variant->eta_r; }},
    column::integrator,
    Column<BrakedRun>(column::h).as("h [s]", "{:.2e}"),
    {"bound", "stability limit [s]", "{:.2e}", &BrakedRun::bound},
    {"y_end", "y at end [m]", "{:.4f}", &BrakedRun::y_at_end},
    {"stops", "stop time [s]", "{:.3f}", &BrakedRun::stop_time},
    {"turns", [](const BrakedRun& run) { return static_cast<long>(run.reversals().size()); }},
    {"F_f_most", "max F_f [N]", "{:.4f}", &BrakedRun::max_friction},
    {"error_r", "error r [m]", "{:.2e}", &BrakedRun::error_r},
    {"error_F_f", &BrakedRun::error_F_f},
    column::iterations,
    column::cpu_seconds,
    column::status};

void evolving_friction(StudyContext& s)
{
    const StudyOptions& options = s.options;
    const std::vector<double> steps = s.steps({friction_step});
    const Schemes schemes = s.fixed_step_schemes({recommended_scheme});
    const std::vector<const BrakedVariant*> selected = selected_parts(s, "scene", braked_variants);
    std::vector<Benchmark> benchmarks;
    for (const BrakedVariant* variant : selected) {
        Problem p = problem("braked_ball_in_bowl");
        const std::string eta_r = fmt::format("/contacts/0/friction/eta_r={}", variant->eta_r);
        p.model = dae::read_model(p.model, p.name, std::vector<std::string>{eta_r}).text;
        p.name = variant->name;
        benchmarks.push_back(
            make_benchmark(std::move(p), options, [](const dae::Description&) { return friction_end; }));
        check_steps(s.name, benchmarks.back(), steps);
    }

    Sweep<BrakedRun> runs;
    const auto add = [&](size_t k, const lie::Scheme& scheme, double h, bool for_check) {
        BrakedRun& run = runs.add(benchmarks[k], scheme, h);
        run.variant = selected[k], run.for_check = for_check;
    };
    for (size_t k = 0; k < selected.size(); ++k)
        for (const lie::Scheme* scheme : schemes)
            for (const double h : steps) {
                add(k, *scheme, h, false);
                if (options.check && selected[k]->eta_r == 0 && h == friction_step)
                    add(k, *scheme, h / 2, true);
            }
    runs.compute(s, [&](BrakedRun& run) { compute(run, options); });

    s.text << "\nBall in a bowl with friction and rolling resistance. max F_f: largest friction "
              "force after 0.1 s; error r: largest position error over the first 3 s (eta_r = 0)\n";
    columns.print(s.text, runs);
    const double end = benchmarks.front().end;
    const bool published_setup = options.set.empty() && end == friction_end;
    std::vector<Criterion> checks;
    CurveTable curves({"eta_r", "run", "h"}, braked_quantities);
    for (const BrakedVariant* variant : selected) {
        for (const BrakedRun* run :
             those(runs, [&](const BrakedRun& r) { return r.variant == variant && !r.for_check; })) {
            if (published_setup) check_run(*run, half_step_run(runs, *run), checks);
            curves.add({variant->eta_r, run->scheme->name, run->h}, run->curve);
            if (variant->eta_r == 0)
                s.measure(run->name(), {{"r", run->error_r}, {"F_f", run->max_friction()}});
            else
                s.measure(run->name(), {{"rest", run->y_at_end()}, {"stops", run->stop_time()}});
        }
        if (options.set.empty()) curves.add({variant->eta_r, "ideal", std::nan("")}, ideal(*variant, end));
    }
    s.evaluate(checks);
    if (!published_setup)
        s.text << "no acceptance criteria are evaluated, because --end or --set changes the runs of the "
                  "dissertation\n";
    if (published_setup && !options.check)
        s.text << "--check adds a run with half of the step and evaluates all acceptance criteria\n";
    if (options.vtk > 0) s.text << fmt::format("frames for ParaView: {}/eta-*.pvd\n", options.output);
    s.table = columns.csv(runs);
    s.files.emplace_back("curves.csv", curves.csv());
    s.figures = {s.name + "-point.png", s.name + "-forces.png"};
    s.end_of_runs(run_pointers(runs));
}

const bool registered_evolving_friction = io::Registry<Study>::add(
    {.name = "evolving-friction",
     .answers = "ball in a bowl with friction and rolling resistance: motion, forces and "
                "rest position (Figs. 5.7, 5.8)",
     .options = options_of_models({"--check", "--vtk", "--strict", "--shard"}),
     .keys = {"r", "F_f", "rest", "stops"},
     .files = {"curves.csv", "evolving-friction-point.png", "evolving-friction-forces.png"},
     .run = evolving_friction});

}  // namespace

}  // namespace hilda::studies
