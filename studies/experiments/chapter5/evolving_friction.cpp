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

#include "io/csv.hpp"
#include "io/error.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/arguments.hpp"
#include "studies/running/contact_rows.hpp"
#include "studies/running/diagnosis.hpp"
#include "studies/running/model_frames.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "reference/motions/planar_bowl.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using reference::ContactInstant;
using reference::PlanarBowl;

const std::string kind = "evolving-friction";
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
constexpr std::array<const char*, sample_size> columns = {"t",   "y",      "z", "F_N",
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
    const dae::Model& model = *run.c->started->model;
    run.bound = model.stable_step(run.c->started->x).h;
    BrakedSampler sampler(run);
    std::vector<lie::Observer*> observers = {&sampler};
    std::optional<ModelFrames> frames;
    if (options.vtk > 0 && !run.for_check) {
        frames.emplace(model, EvenSelection(options.vtk, std::lround(run.c->end / run.h)));
        observers.push_back(&*frames);
    }
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-13);  // below the errors in the table
    march(run, settings, observers);
    if (options.set.empty()) compare_with_reference(run);
    const std::string name = fmt::format("{}-{}-{}", run.variant->name, run.scheme->name, step_text(run.h));
    if (options.force && !options.output.empty()) Snapshots::remove(options.output, name);
    if (frames) frames->snapshots.write(options.output, name);
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

void add_row(std::string& csv, double eta_r, const std::string& run, double h, const BrakedSample& s)
{
    io::append_number(csv, eta_r);
    csv += ',' + io::csv_field(run) + ',';
    if (h > 0) io::append_number(csv, h);
    for (const double value : s) {
        csv += ',';
        io::append_number(csv, value);
    }
    csv += '\n';
}

/// Ideal limit: rolling without slip, the rolling resistance has its kinetic value as soon as the ball rolls
void add_ideal(std::string& csv, const BrakedVariant& variant, double end)
{
    std::vector<double> instants;
    for (size_t k = 0; k < ideal_rows; ++k)
        instants.push_back(end * static_cast<double>(k) / static_cast<double>(ideal_rows - 1));
    for (const ContactInstant& at :
         PlanarBowl{}.resist({.y = y_start}, {.eta = variant.eta_r}, instants).instant)
        add_row(csv, variant.eta_r, "ideal", 0,
                {at.t, at.p.y(), at.p.z(), at.F_N, at.F_t.norm(), at.moment.norm(), at.body.rdot.norm(),
                 at.body.omega_bar.norm()});
}

std::string curves(const std::vector<BrakedRun>& runs, const std::vector<const BrakedVariant*>& selected,
                   double end, bool with_ideal)
{
    std::string csv = "eta_r,run,h";
    for (const char* column : columns) csv += std::string(",") + column;
    csv += '\n';
    for (const BrakedVariant* s : selected) {
        for (const BrakedRun& run : runs)
            if (run.variant == s && !run.for_check)
                for (const BrakedSample& node : run.sample)
                    add_row(csv, s->eta_r, run.scheme->name, run.h, node);
        if (with_ideal) add_ideal(csv, *s, end);
    }
    return csv;
}

Table as_table(const std::vector<BrakedRun>& runs)
{
    Table table({{"eta_r"},
                 {"integrator"},
                 {"h"},
                 {"bound"},
                 {"y_end"},
                 {"stops"},
                 {"turns"},
                 {"F_f_most"},
                 {"error_r"},
                 {"error_F_f"},
                 {"iterations_per_step"},
                 {"cpu_seconds"},
                 {"status"}});
    for (const BrakedRun& run : runs)
        table.add({run.variant->eta_r, run.scheme->name, run.h, run.bound, run.y_at_end(), run.stop_time(),
                   static_cast<double>(run.reversals().size()), run.max_friction(), run.error_r,
                   run.error_F_f, run.statistics.iterations_per_step(), run.seconds, run.status});
    return table;
}

void print(const std::vector<BrakedRun>& runs, std::ostream& out)
{
    Table table({{"eta_r", "{:g}"},
                 {"integrator"},
                 {"h [s]", "{:.2e}"},
                 {"stability limit [s]", "{:.2e}"},
                 {"y at end [m]", "{:.4f}"},
                 {"stop time [s]", "{:.3f}"},
                 {"max F_f [N]", "{:.4f}"},
                 {"error r [m]", "{:.2e}"},
                 {"iter", "{:.2f}"},
                 {"status"}});
    for (const BrakedRun& run : runs)
        table.add({run.variant->eta_r, run.scheme->name, run.h, run.bound, run.y_at_end(), run.stop_time(),
                   run.max_friction(), run.error_r, run.statistics.iterations_per_step(), run.status});
    out << "\nBall in a bowl with friction and rolling resistance. max F_f: largest friction force after 0.1 "
           "s; "
           "error r: largest position error over the first 3 s (eta_r = 0)\n";
    table.print(out);
}

std::vector<const BrakedVariant*> selected_variants(const StudyOptions& options)
{
    std::vector<std::string> known;
    known.reserve(variants.size());
    for (const BrakedVariant& s : variants) known.push_back(s.name);
    for (const std::string& name : options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw io::UsageError("study " + kind + ": unknown scene" + with_nearest(name, known));
    std::vector<const BrakedVariant*> selected;
    for (const BrakedVariant& s : variants)
        if (options.problems.empty() ||
            std::find(options.problems.begin(), options.problems.end(), s.name) != options.problems.end())
            selected.push_back(&s);
    return selected;
}

int study(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"r", "F_f", "rest", "stops"});
    check_vtk(kind, options);
    const std::vector<double> steps = steps_or(options, {default_step});
    const Schemes schemes = fixed_step_schemes(kind, options, {recommended_scheme});
    const std::vector<const BrakedVariant*> selected = selected_variants(options);
    std::vector<Benchmark> benchmarks;
    for (const BrakedVariant* s : selected) {
        Problem p = problem("braked_ball_in_bowl");
        p.model =
            dae::read_model(p.model, p.name,
                            std::vector<std::string>{fmt::format("/contacts/0/friction/eta_r={}", s->eta_r)})
                .text;
        p.name = s->name;
        benchmarks.push_back(
            make_benchmark(std::move(p), options, [](const dae::Description&) { return default_end; }));
        check_steps(kind, benchmarks.back(), steps);
    }

    std::vector<BrakedRun> runs;
    const auto add = [&](size_t k, const lie::Scheme& scheme, double h, bool for_check) {
        BrakedRun run;
        run.c = &benchmarks[k], run.scheme = &scheme, run.h = h;
        run.variant = selected[k], run.for_check = for_check;
        runs.push_back(std::move(run));
    };
    for (size_t k = 0; k < selected.size(); ++k)
        for (const lie::Scheme* scheme : schemes)
            for (const double h : steps) {
                add(k, *scheme, h, false);
                if (options.check && selected[k]->eta_r == 0 && h == default_step)
                    add(k, *scheme, h / 2, true);
            }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    const double end = benchmarks.front().end;
    const bool published_setup = options.set.empty() && end == default_end;
    StudyOutput output{.kind = kind, .table = as_table(runs).csv()};
    print(runs, output.text);
    std::vector<Criterion> checks;
    std::vector<Measured> measurements;
    for (const BrakedRun& run : runs) {
        if (run.for_check) continue;
        const auto half = std::find_if(runs.begin(), runs.end(), [&](const BrakedRun& other) {
            return other.for_check && other.variant == run.variant && other.scheme == run.scheme;
        });
        if (published_setup) check_run(run, half == runs.end() ? nullptr : &*half, checks);
        Measured measured{.of = run.name(), .value = {}};
        if (run.variant->eta_r == 0)
            measured.value = {{"r", run.error_r}, {"F_f", run.max_friction()}};
        else
            measured.value = {{"rest", run.y_at_end()}, {"stops", run.stop_time()}};
        measurements.push_back(std::move(measured));
    }
    const bool passed = evaluate(checks, output.text, output.json);
    if (!published_setup)
        output.text << "no acceptance criteria are evaluated, because --end or --set changes the runs of the "
                       "dissertation\n";
    if (published_setup && !options.check)
        output.text << "--check adds a run with half of the step and evaluates all acceptance criteria\n";
    if (options.vtk > 0) output.text << fmt::format("frames for ParaView: {}/eta-*.pvd\n", options.output);
    output.files.emplace_back("curves.csv", curves(runs, selected, end, options.set.empty()));
    output.figures = {kind + "-point.png", kind + "-forces.png"};
    const int code = finish(options, output, run_pointers(runs), measurements);
    return code == io::exit_code::done && options.check && !passed ? io::exit_code::expectation_failed : code;
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "ball in a bowl with friction and rolling resistance: motion, forces and "
                                    "rest position (Figs. 5.7, 5.8)",
                         .accepted = takes::check | takes::vtk,
                         .run = study});

}  // namespace

}  // namespace hilda::studies
