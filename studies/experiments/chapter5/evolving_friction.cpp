// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball in an ellipsoidal bowl that friction makes roll and rolling resistance brings to rest (Fang 2022, Sec. 5.5.2,
/// Table 5.1, Figs. 5.7, 5.8).
///
/// The contact points are unknowns, and friction is that of Chapter 4 on their ways over both bodies. The ball is let go at
/// the contact point (0, 1.5), with rolling resistance η_r = 0, 0.1, 0.2 and 0.3. curves.csv has the contact point, the
/// forces, the rolling torque and the speeds at every node, and those of the ideal limit: rolling without slip against a
/// resistance without a spring. The table sets what comes out beside what must; --check does the run without resistance at
/// half of the step too, and exits with 6 where a demand is not met.
///
/// The step of the text, 5e-3 s, is above the 4.64e-3 s that the friction springs of a homogeneous ball stand.

#include "studies/csv.hpp"
#include "studies/exit_codes.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/arguments.hpp"
#include "studies/running/contact_rows.hpp"
#include "studies/running/diagnosis.hpp"
#include "studies/running/model_frames.hpp"

#include "reference/motions/planar_bowl.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using nlohmann::ordered_json;
using reference::ContactInstant;
using reference::PlanarBowl;

const std::string kind = "evolving-friction";
const std::string text = "rA-half-1", recommended = "rA-half-1-momentum";
constexpr double usual_step = 2.5e-3, usual_end = 10;
constexpr double begins = 1.5;       // y of the contact point at the start [m]
constexpr double settled = 0.1;      // the springs have taken up the release [s]
constexpr double compared_to = 3;    // of the run without resistance, with its equation in one angle [s]
constexpr size_t ideal_rows = 1001;  // of an ideal limit in the CSV

/// A run of the text, with what must come out: numbers of its ideal limit and, for the rest, of the springs
struct BrakedVariant {
    std::string name;
    double eta_r;
    double rest = std::nan("");      ///< y of the contact point [m]
    double stops = std::nan("");     ///< [s]
    std::vector<double> turns = {};  ///< y of the contact point where the ball turns round [m]
};
const std::vector<BrakedVariant> scenes = {
    {.name = "eta-0", .eta_r = 0},
    {.name = "eta-0.1", .eta_r = 0.1, .rest = -0.0929, .stops = 9.406, .turns = {-1.1110, 0.7137, -0.3114}},
    {.name = "eta-0.2", .eta_r = 0.2, .rest = -0.0859, .stops = 4.675, .turns = {-0.7170}},
    {.name = "eta-0.3", .eta_r = 0.3, .rest = -0.3250, .stops = 2.309}};

/// What a node says, in the order of the columns of curves.csv
enum : int { t, y, z, F_N, F_f, torque, speed, omega, samples };
constexpr std::array<const char*, samples> columns = {"t", "y", "z", "F_N", "F_f", "torque", "v", "omega"};
using Sample = std::array<double, samples>;

/// Where the ball turns round
struct Turn {
    double t, y;
};

struct BrakedRun : Run {
    const BrakedVariant* scene = nullptr;
    bool for_check = false;
    std::vector<Sample> sample;
    std::vector<lie::Vec3> r;  ///< of the centre, while it is compared

    double bound = 0;  ///< largest stable step [s]
    /// Against the equation in one angle [m, N]; of r the largest and that of the last instant, for in the jolt of the
    /// release the friction of a step before is of first order
    double error_r = std::nan(""), error_r_last = std::nan(""), error_F_f = std::nan("");

    double most_friction() const
    {
        double most = failed() ? std::nan("") : 0;
        for (const Sample& s : sample)
            if (s[t] > settled) most = std::max(most, s[F_f]);
        return most;
    }
    /// At the extremes of y, each by a parabola through three nodes
    std::vector<Turn> turns() const
    {
        std::vector<Turn> all;
        for (size_t k = 2; k < sample.size(); ++k) {
            const double a = sample[k - 2][y], b = sample[k - 1][y], c = sample[k][y];
            if ((c - b) * (b - a) >= 0 || std::abs(c - begins) < 0.1) continue;
            const double bend = a - 2 * b + c, ahead = (a - c) / (2 * bend);
            all.push_back({sample[k - 1][t] + ahead * h, b - (a - c) * (a - c) / (8 * bend)});
        }
        return all;
    }
    double y_at_end() const { return failed() ? std::nan("") : sample.back()[y]; }
    /// The turn after those of the scene is the one that it does not leave.
    double stops() const
    {
        const std::vector<Turn> all = turns();
        return scene->eta_r > 0 && all.size() > scene->turns.size() ? all[scene->turns.size()].t
                                                                    : std::nan("");
    }
};

class Watch final : public lie::Observer {
public:
    explicit Watch(BrakedRun& run)
        : run(run), model(*run.c->started->model), contact(*evolving_contacts(model).front()),
          friction(*forces_of(model, contact).friction)
    {}

    void accepted(const lie::State& x, long /*n*/, int) override
    {
        const lie::Motion& ball = x.body[0];
        const contact::Wrench by = friction.friction(x);
        const lie::Vec3 p = lie::Vec3::Map(x.alpha.data() + 3);
        run.sample.push_back({x.t, p.y(), p.z(), forces(model, contact, x).F_N, by.F.norm(), by.T_i.norm(),
                              ball.rdot.norm(), ball.omega_bar.norm()});
        if (run.scene->eta_r == 0 && x.t <= compared_to) run.r.push_back(ball.r);
    }

private:
    BrakedRun& run;
    const dae::Model& model;
    const contact::EvolvingContact& contact;
    const contact::EvolvingFriction& friction;
};

/// Without resistance the ball follows one equation, whose friction is smooth.
void compare(BrakedRun& run)
{
    if (run.scene->eta_r != 0 || run.failed()) return;
    std::vector<double> instants;
    for (size_t k = 0; k < run.r.size(); ++k) instants.push_back(run.sample[k][t]);
    const std::vector<ContactInstant> reference_solution = PlanarBowl{}.spring({.y = begins}, {}, instants);
    run.error_r = run.error_F_f = 0;
    for (size_t k = 0; k < reference_solution.size(); ++k) {
        run.error_r_last = (run.r[k] - reference_solution[k].body.r).norm();
        run.error_r = std::max(run.error_r, run.error_r_last);
        if (instants[k] > settled)
            run.error_F_f =
                std::max(run.error_F_f, std::abs(run.sample[k][F_f] - reference_solution[k].F_t.norm()));
    }
}

void compute(BrakedRun& run, const StudyOptions& options)
{
    const dae::Model& model = *run.c->started->model;
    run.bound = model.stable_step(run.c->started->x).h;
    Watch watch(run);
    std::vector<lie::Observer*> observers = {&watch};
    std::optional<ModelFrames> frames;
    if (options.vtk > 0 && !run.for_check) {
        frames.emplace(model, EvenChoice(options.vtk, std::lround(run.c->end / run.h)));
        observers.push_back(&*frames);
    }
    lie::Settings settings = options.settings;
    settings.tolerance = std::min(settings.tolerance, 1e-13);  // below the errors that are shown
    march(run, settings, observers);
    if (options.set.empty()) compare(run);
    const std::string name = fmt::format("{}-{}-{}", run.scene->name, run.scheme->name, step_text(run.h));
    if (options.force && !options.output.empty()) Snapshots::remove(options.output, name);
    if (frames) frames->snapshots.write(options.output, name);
}

std::string label(const BrakedRun& run)
{
    return fmt::format(", {} by {} at {} s", run.scene->name, run.scheme->name, step_text(run.h));
}

void evaluate_run(const BrakedRun& run, const BrakedRun* half, std::vector<Criterion>& must)
{
    const std::string of = label(run);
    const BrakedVariant& s = *run.scene;
    if (s.eta_r == 0) {
        must.push_back(criterion("largest friction after 0.1 s [N]" + of, run.most_friction(), 1.007, 5e-3));
        must.push_back(between("friction against the equation in one angle [N]" + of, run.error_F_f, 0,
                               run.scheme->name == text ? 1e-2 : 5e-3));
        if (run.h != usual_step) return;
        if (run.scheme->name == text)
            must.push_back(criterion("error of position, 3 s [m]" + of, run.error_r, 2.3e-3, 1e-4));
        if (run.scheme->name == recommended)
            must.push_back(between("error of position, 3 s [m]" + of, run.error_r, 0, 3e-6));
        if (half != nullptr && !half->failed() &&
            (run.scheme->name == text || run.scheme->name == recommended))
            must.push_back(criterion("order of position at 3 s" + of,
                                     std::log2(run.error_r_last / half->error_r_last),
                                     run.scheme->name == text ? 1 : 2, 0.05));
        return;
    }
    must.push_back(criterion("comes to rest at y [m]" + of, run.y_at_end(), s.rest, 1e-3));
    must.push_back(criterion("stops at t [s]" + of, run.stops(), s.stops, 0.03));
    must.push_back(between("speed at the end [m/s]" + of,
                           run.failed() ? std::nan("") : run.sample.back()[speed], 0, 1e-4));
    const std::vector<Turn> turns = run.turns();
    for (size_t k = 0; k < s.turns.size(); ++k)
        must.push_back(criterion(fmt::format("turn {} at y [m]{}", k + 1, of),
                                 k < turns.size() ? turns[k].y : std::nan(""), s.turns[k], 1e-3));
}

void add_row(std::string& csv, double eta_r, const std::string& run, double h, const Sample& s)
{
    append_number(csv, eta_r);
    csv += ',' + csv_field(run) + ',';
    if (h > 0) append_number(csv, h);
    for (const double value : s) {
        csv += ',';
        append_number(csv, value);
    }
    csv += '\n';
}

/// Rolling without slip, and a resistance that is full as soon as the ball rolls
void add_ideal(std::string& csv, const BrakedVariant& scene, double end)
{
    std::vector<double> instants;
    for (size_t k = 0; k < ideal_rows; ++k)
        instants.push_back(end * static_cast<double>(k) / static_cast<double>(ideal_rows - 1));
    for (const ContactInstant& at :
         PlanarBowl{}.resist({.y = begins}, {.eta = scene.eta_r}, instants).instant)
        add_row(csv, scene.eta_r, "ideal", 0,
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
            if (run.scene == s && !run.for_check)
                for (const Sample& of : run.sample) add_row(csv, s->eta_r, run.scheme->name, run.h, of);
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
        table.add({run.scene->eta_r, run.scheme->name, run.h, run.bound, run.y_at_end(), run.stops(),
                   static_cast<double>(run.turns().size()), run.most_friction(), run.error_r, run.error_F_f,
                   run.statistics.iterations_per_step(), run.seconds, run.status});
    return table;
}

void print(const std::vector<BrakedRun>& runs, std::ostream& out)
{
    Table table({{"eta_r", "{:g}"},
                 {"integrator"},
                 {"h [s]", "{:.2e}"},
                 {"stable to [s]", "{:.2e}"},
                 {"y at the end [m]", "{:.4f}"},
                 {"stops [s]", "{:.3f}"},
                 {"F_f [N]", "{:.4f}"},
                 {"r [m]", "{:.2e}"},
                 {"iter", "{:.2f}"},
                 {"status"}});
    for (const BrakedRun& run : runs)
        table.add({run.scene->eta_r, run.scheme->name, run.h, run.bound, run.y_at_end(), run.stops(),
                   run.most_friction(), run.error_r, run.statistics.iterations_per_step(), run.status});
    out << "\na ball in a bowl, rolling against resistance; F_f is the most after 0.1 s, r the error over "
           "the "
           "first 3 s\n";
    table.print(out);
}

std::vector<const BrakedVariant*> selected_variants(const StudyOptions& options)
{
    std::vector<std::string> known;
    known.reserve(scenes.size());
    for (const BrakedVariant& s : scenes) known.push_back(s.name);
    for (const std::string& name : options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw UsageError("study " + kind + ": unknown scene" + with_nearest(name, known));
    std::vector<const BrakedVariant*> selected;
    for (const BrakedVariant& s : scenes)
        if (options.problems.empty() ||
            std::find(options.problems.begin(), options.problems.end(), s.name) != options.problems.end())
            selected.push_back(&s);
    return selected;
}

int study(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"r", "F_f", "rest", "stops"});
    check_vtk(kind, options);
    const std::vector<double> steps = steps_or(options, {usual_step});
    const Schemes schemes = fixed_step_schemes(kind, options, {recommended});
    const std::vector<const BrakedVariant*> selected = selected_variants(options);
    std::vector<Benchmark> benchmarks;
    for (const BrakedVariant* s : selected) {
        Problem of = problem("braked_ball_in_bowl");
        of.model =
            dae::read_model(of.model, of.name,
                            std::vector<std::string>{fmt::format("/contacts/0/friction/eta_r={}", s->eta_r)})
                .text;
        of.name = s->name;
        benchmarks.push_back(
            make_benchmark(std::move(of), options, [](const dae::Description&) { return usual_end; }));
        check_steps(kind, benchmarks.back(), steps);
    }

    std::vector<BrakedRun> runs;
    const auto add = [&](size_t k, const lie::Scheme& scheme, double h, bool for_check) {
        BrakedRun run;
        run.c = &benchmarks[k], run.scheme = &scheme, run.h = h;
        run.scene = selected[k], run.for_check = for_check;
        runs.push_back(std::move(run));
    };
    for (size_t k = 0; k < selected.size(); ++k)
        for (const lie::Scheme* scheme : schemes)
            for (const double h : steps) {
                add(k, *scheme, h, false);
                if (options.check && selected[k]->eta_r == 0 && h == usual_step) add(k, *scheme, h / 2, true);
            }
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(runs.size())).run([&](long k) {
        compute(runs[k], options);
    });

    const double end = benchmarks.front().end;
    const bool as_in_text = options.set.empty() && end == usual_end;
    StudyOutput output{.kind = kind, .table = as_table(runs).csv()};
    print(runs, output.text);
    std::vector<Criterion> must;
    std::vector<Measured> came;
    for (const BrakedRun& run : runs) {
        if (run.for_check) continue;
        const auto half = std::find_if(runs.begin(), runs.end(), [&](const BrakedRun& other) {
            return other.for_check && other.scene == run.scene && other.scheme == run.scheme;
        });
        if (as_in_text) evaluate_run(run, half == runs.end() ? nullptr : &*half, must);
        Measured measured{.of = run.name(), .value = {}};
        if (run.scene->eta_r == 0)
            measured.value = {{"r", run.error_r}, {"F_f", run.most_friction()}};
        else
            measured.value = {{"rest", run.y_at_end()}, {"stops", run.stops()}};
        came.push_back(std::move(measured));
    }
    const bool passed = evaluate(must, output.text, output.json);
    if (!as_in_text) output.text << "--end and --set ask for other runs than those of the text: no demands\n";
    if (as_in_text && !options.check)
        output.text << "--check does a run at half of the step too, and judges by all\n";
    if (options.vtk > 0) output.text << fmt::format("for ParaView: {}/eta-*.pvd\n", options.output);
    output.files.emplace_back("curves.csv", curves(runs, selected, end, options.set.empty()));
    output.figures = {kind + "-point.png", kind + "-forces.png"};
    const int code = finish(options, output, run_pointers(runs), came);
    return code == exit_code::done && options.check && !passed ? exit_code::expectation_failed : code;
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "ball in a bowl that friction brings to rest (Figs. 5.7, 5.8)",
                         .also = takes::check | takes::vtk,
                         .run = study});

}  // namespace

}  // namespace hilda::studies
