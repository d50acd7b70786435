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

#include "studies/experiments/chapter5/model_with_frames.hpp"
#include "studies/framework/sweep.hpp"
#include "studies/running/contact_rows.hpp"
#include "studies/running/diagnosis.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "reference/motions/planar_bowl.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using reference::ContactInstant;
using reference::PlanarBowl;

const std::string dissertation_scheme = "rA-half-1", recommended_scheme = "rA-half-1-momentum";
constexpr double default_step = 2.5e-3, default_end = 10;
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
const std::vector<BrakedVariant> variants = {
    {.name = "eta-0", .eta_r = 0},
    {.name = "eta-0.1",
     .eta_r = 0.1,
     .y_rest = -0.0929,
     .stop_time = 9.406,
     .reversals = {-1.1110, 0.7137, -0.3114}},
    {.name = "eta-0.2", .eta_r = 0.2, .y_rest = -0.0859, .stop_time = 4.675, .reversals = {-0.7170}},
    {.name = "eta-0.3", .eta_r = 0.3, .y_rest = -0.3250, .stop_time = 2.309}};

/// Quantities recorded at every node, in the order of the columns of curves.csv
enum : int { t, y, z, F_N, F_f, torque, speed, omega, sample_size };
constexpr std::array<const char*, sample_size> quantities = {"t",   "y",      "z", "F_N",
                                                             "F_f", "torque", "v", "omega"};
using BrakedSample = std::array<double, sample_size>;

/// Reversal of motion: time [s] and y of the contact point [m]
struct Reversal {
    double t, y;
};

struct BrakedRun : Run {
    const BrakedVariant* variant = nullptr;
    bool for_check = false;
    std::vector<BrakedSample> sample;
    std::vector<lie::Vec3> r;  ///< centre of the ball, for the comparison with the one-angle equation

    double bound = 0;  ///< largest stable step [s]
    /// Errors relative to the one-angle equation [m, N]: largest error of r, error of r at the last instant,
    /// largest error of the friction. The order of r is measured at the last instant, because during the
    /// transient of the release the friction of the previous step causes an error of first order.
    double error_r = std::nan(""), error_r_last = std::nan(""), error_F_f = std::nan("");

    double max_friction() const
    {
        double largest = failed() ? std::nan("") : 0;
        for (const BrakedSample& s : sample)
            if (s[t] > transient) largest = std::max(largest, s[F_f]);
        return largest;
    }
    /// Extrema of y, each from a parabola through three nodes
    std::vector<Reversal> reversals() const
    {
        std::vector<Reversal> all;
        for (size_t k = 2; k < sample.size(); ++k) {
            const double a = sample[k - 2][y], b = sample[k - 1][y], c = sample[k][y];
            if ((c - b) * (b - a) >= 0 || std::abs(c - y_start) < 0.1) continue;
            const double curvature = a - 2 * b + c, offset = (a - c) / (2 * curvature);
            all.push_back({sample[k - 1][t] + offset * h, b - (a - c) * (a - c) / (8 * curvature)});
        }
        return all;
    }
    double y_at_end() const { return failed() ? std::nan("") : sample.back()[y]; }
    /// The first reversal after those of the variant: the ball does not start again from there.
    double stop_time() const
    {
        const std::vector<Reversal> all = reversals();
        return variant->eta_r > 0 && all.size() > variant->reversals.size() ? all[variant->reversals.size()].t
                                                                            : std::nan("");
    }
};

class BrakedSampler final : public lie::Observer {
public:
    explicit BrakedSampler(BrakedRun& run)
        : run(run), model(*run.c->started->model), contact(*evolving_contacts(model).front()),
          friction(*find_force_elements(model, contact).friction)
    {}

    void accepted(const lie::State& x, long /*n*/, int) override
    {
        const lie::Motion& ball = x.body[0];
        const contact::Wrench by = friction.friction(x);
        const lie::Vec3 p = lie::Vec3::Map(x.alpha.data() + 3);
        run.sample.push_back({x.t, p.y(), p.z(), forces(model, contact, x).F_N, by.F.norm(), by.T_i.norm(),
                              ball.rdot.norm(), ball.omega_bar.norm()});
        if (run.variant->eta_r == 0 && x.t <= comparison_end) run.r.push_back(ball.r);
    }

private:
    BrakedRun& run;
    const dae::Model& model;
    const contact::EvolvingContact& contact;
    const contact::EvolvingFriction& friction;
};

/// Without rolling resistance the motion follows one equation in one angle with a smooth friction force.
void compare_with_reference(BrakedRun& run)
{
    if (run.variant->eta_r != 0 || run.failed()) return;
    std::vector<double> instants;
    for (size_t k = 0; k < run.r.size(); ++k) instants.push_back(run.sample[k][t]);
    const std::vector<ContactInstant> reference_solution = PlanarBowl{}.spring({.y = y_start}, {}, instants);
    run.error_r = run.error_F_f = 0;
    for (size_t k = 0; k < reference_solution.size(); ++k) {
        run.error_r_last = (run.r[k] - reference_solution[k].body.r).norm();
        run.error_r = std::max(run.error_r, run.error_r_last);
        if (instants[k] > transient)
            run.error_F_f =
                std::max(run.error_F_f, std::abs(run.sample[k][F_f] - reference_solution[k].F_t.norm()));
    }
}

void compute(BrakedRun& run, const StudyOptions& options)
{
    run.bound = run.c->started->model->stable_step(run.c->started->x).h;
    BrakedSampler sampler(run);
    const std::string name = fmt::format("{}-{}-{}", run.variant->name, run.scheme->name, step_text(run.h));
    march_with_frames(run, options, 1e-13, {&sampler}, name,
                      !run.for_check);  // below the errors in the table
    if (options.set.empty()) compare_with_reference(run);
}

std::string label(const BrakedRun& run)
{
    return fmt::format(", {} by {} at {} s", run.variant->name, run.scheme->name, step_text(run.h));
}

void check_run(const BrakedRun& run, const BrakedRun* half, std::vector<Criterion>& checks)
{
    const std::string suffix = label(run);
    const BrakedVariant& s = *run.variant;
    if (s.eta_r == 0) {
        checks.push_back(
            criterion("largest friction after 0.1 s [N]" + suffix, run.max_friction(), 1.007, 5e-3));
        checks.push_back(between("error of the friction relative to the one-angle equation [N]" + suffix,
                                 run.error_F_f, 0, run.scheme->name == dissertation_scheme ? 1e-2 : 5e-3));
        if (run.h != default_step) return;
        if (run.scheme->name == dissertation_scheme)
            checks.push_back(criterion("error of position, 3 s [m]" + suffix, run.error_r, 2.3e-3, 1e-4));
        if (run.scheme->name == recommended_scheme)
            checks.push_back(between("error of position, 3 s [m]" + suffix, run.error_r, 0, 3e-6));
        if (half != nullptr && !half->failed() &&
            (run.scheme->name == dissertation_scheme || run.scheme->name == recommended_scheme))
            checks.push_back(criterion("order of position at 3 s" + suffix,
                                       std::log2(run.error_r_last / half->error_r_last),
                                       run.scheme->name == dissertation_scheme ? 1 : 2, 0.05));
        return;
    }
    checks.push_back(criterion("y at rest [m]" + suffix, run.y_at_end(), s.y_rest, 1e-3));
    checks.push_back(criterion("stop time [s]" + suffix, run.stop_time(), s.stop_time, 0.03));
    checks.push_back(between("speed at the end [m/s]" + suffix,
                             run.failed() ? std::nan("") : run.sample.back()[speed], 0, 1e-4));
    const std::vector<Reversal> reversals = run.reversals();
    for (size_t k = 0; k < s.reversals.size(); ++k)
        checks.push_back(criterion(fmt::format("reversal {} at y [m]{}", k + 1, suffix),
                                   k < reversals.size() ? reversals[k].y : std::nan(""), s.reversals[k],
                                   1e-3));
}

/// Rows of curves.csv; h is NaN for the ideal limit
void add_row(Table& table, double eta_r, const std::string& run, double h, const BrakedSample& sample)
{
    std::vector<Table::Cell> row = {eta_r, run, h};
    row.insert(row.end(), sample.begin(), sample.end());
    table.add(row);
}

/// Ideal limit: rolling without slip, the rolling resistance has its kinetic value as soon as the ball rolls
void add_ideal(Table& table, const BrakedVariant& variant, double end)
{
    std::vector<double> instants;
    for (size_t k = 0; k < ideal_rows; ++k)
        instants.push_back(end * static_cast<double>(k) / static_cast<double>(ideal_rows - 1));
    for (const ContactInstant& at :
         PlanarBowl{}.resist({.y = y_start}, {.eta = variant.eta_r}, instants).instant)
        add_row(table, variant.eta_r, "ideal", std::nan(""),
                {at.t, at.p.y(), at.p.z(), at.F_N, at.F_t.norm(), at.moment.norm(), at.body.rdot.norm(),
                 at.body.omega_bar.norm()});
}

std::string curves(const std::vector<BrakedRun>& runs, const std::vector<const BrakedVariant*>& selected,
                   double end, bool with_ideal)
{
    std::vector<Table::Column> titles = {{"eta_r"}, {"run"}, {"h"}};
    for (const char* name : quantities) titles.push_back({name});
    Table table(titles);
    for (const BrakedVariant* variant : selected) {
        for (const BrakedRun& run : runs)
            if (run.variant == variant && !run.for_check)
                for (const BrakedSample& node : run.sample)
                    add_row(table, variant->eta_r, run.scheme->name, run.h, node);
        if (with_ideal) add_ideal(table, *variant, end);
    }
    return table.csv();
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
    const std::vector<double> steps = s.steps({default_step});
    const Schemes schemes = s.fixed_step_schemes({recommended_scheme});
    const std::vector<const BrakedVariant*> selected = selected_parts(s, "scene", variants);
    std::vector<Benchmark> benchmarks;
    for (const BrakedVariant* variant : selected) {
        Problem p = problem("braked_ball_in_bowl");
        const std::string eta_r = fmt::format("/contacts/0/friction/eta_r={}", variant->eta_r);
        p.model = dae::read_model(p.model, p.name, std::vector<std::string>{eta_r}).text;
        p.name = variant->name;
        benchmarks.push_back(
            make_benchmark(std::move(p), options, [](const dae::Description&) { return default_end; }));
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
                if (options.check && selected[k]->eta_r == 0 && h == default_step)
                    add(k, *scheme, h / 2, true);
            }
    runs.compute(s, [&](BrakedRun& run) { compute(run, options); });

    s.text
        << "\nBall in a bowl with friction and rolling resistance. max F_f: largest friction force after 0.1 "
           "s; "
           "error r: largest position error over the first 3 s (eta_r = 0)\n";
    columns.print(s.text, runs);
    const double end = benchmarks.front().end;
    const bool published_setup = options.set.empty() && end == default_end;
    std::vector<Criterion> checks;
    for (const BrakedRun& run : runs) {
        if (run.for_check) continue;
        const auto half = those(runs, [&](const BrakedRun& other) {
            return other.for_check && other.variant == run.variant && other.scheme == run.scheme;
        });
        if (published_setup) check_run(run, half.empty() ? nullptr : half.front(), checks);
        Measured& measured = s.measured.emplace_back(Measured{.of = run.name(), .value = {}});
        if (run.variant->eta_r == 0)
            measured.value = {{"r", run.error_r}, {"F_f", run.max_friction()}};
        else
            measured.value = {{"rest", run.y_at_end()}, {"stops", run.stop_time()}};
    }
    s.evaluate(checks);
    if (!published_setup)
        s.text << "no acceptance criteria are evaluated, because --end or --set changes the runs of the "
                  "dissertation\n";
    if (published_setup && !options.check)
        s.text << "--check adds a run with half of the step and evaluates all acceptance criteria\n";
    if (options.vtk > 0) s.text << fmt::format("frames for ParaView: {}/eta-*.pvd\n", options.output);
    s.table = columns.csv(runs);
    s.files.emplace_back("curves.csv", curves(runs, selected, end, options.set.empty()));
    s.figures = {s.name + "-point.png", s.name + "-forces.png"};
    s.end_of_runs(run_pointers(runs));
}

const bool registered = io::Registry<Study>::add(
    {.name = "evolving-friction",
     .answers = "ball in a bowl with friction and rolling resistance: motion, forces and "
                "rest position (Figs. 5.7, 5.8)",
     .accepted = takes::check | takes::vtk,
     .keys = {"r", "F_f", "rest", "stops"},
     .run = evolving_friction});

}  // namespace

}  // namespace hilda::studies
