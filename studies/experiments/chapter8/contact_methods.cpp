// SPDX-License-Identifier: GPL-3.0-or-later
/// What evolving contact, a differential variational inequality (DVI) and springs (DEM) ask for an accuracy, and where
/// each of them ends. (The comparison that Fang 2022, Sec. 8.2 leaves to do.)
///
/// bowl    A ball slides in the bowl of Sec. 5.5 from (1, 1.5) for 2 s: position against the motion in minimal
///         coordinates, over CPU time. All methods start with half a kick, so that what shows is the method.
/// many    That ball 1 to 10000 times in one bowl, each by itself: CPU time of a step and contact.
/// chain   Balls in a row in a groove down a slope, held by the first, 1 to 3333, three contacts a ball: forces that go
///         through all of them. At rest; what moves is wrong.
/// pile    Balls fall into a bowl without friction: contacts come and go, and may be more than the freedoms.

#include "studies/exit_codes.hpp"
#include "studies/experiments/chapter8/method.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/framework/table.hpp"
#include "studies/program/arguments.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/check.hpp"
#include "reference/motions/ball_in_bowl.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using lie::Vec3;
using methods::Method;
using nlohmann::ordered_json;

const std::string kind = "contact-methods";
const std::vector<std::string> parts = {"bowl", "many", "chain", "pile"};

/// One method on one scene at one step
struct MethodRun {
    std::string part, method;
    double h = 0, end = 0;
    double stiffness = std::nan("");  ///< of springs [N/m]
    int bodies = 1;
    std::function<std::unique_ptr<Method>()> make = {};
    /// What is wrong at the end of a step [m], where that is known; and how it is judged at the end
    std::function<double(const Method&, double t)> error = {};

    int contacts = 0, events = 0;
    long steps = 0, iterations = 0;
    double largest_error = std::nan(""), seconds = 0;
    std::string status = "ok", message = {};

    double microseconds() const { return 1e6 * seconds / static_cast<double>(steps); }
    double of_contact() const { return microseconds() / std::max(1, contacts); }
};

// ---- the bowl of Sec. 5.5 --------------------------------------------------------------------------------------------

const reference::BallInBowl bowl;

/// The bowl, which is body 0, and balls that start at rest where these points of it are touched
ContactScene bowl_with(const std::vector<Vec3>& touched)
{
    ContactScene of;
    of.R = bowl.R, of.m = bowl.m;
    contact::BodyType hollow;
    hollow.shape = {std::make_shared<contact::Ellipsoid>(bowl.semi_axes, true)};
    of.kind = {hollow,
               {.inertia = {bowl.m, bowl.J * lie::Mat3::Identity()},
                .shape = {std::make_shared<contact::Sphere>(bowl.R)},
                .reach = bowl.R}};
    of.interaction = {{"ball-bowl", 1, 0, 0}};
    of.body = {{0, {}}};
    for (const Vec3& p : touched) {
        lie::Motion start;
        start.r = p + bowl.R * bowl.normal(p);
        of.body.push_back({1, start});
    }
    return of;
}

/// So that springs of stiffness k carry from the first step on, and velocities are half a step back
ContactScene leaning(ContactScene of, const reference::ContactInstant& at_rest, double k, double h)
{
    lie::Motion& ball = of.body[1].start;
    ball.r -= at_rest.F_N / k * at_rest.n;
    ball.rdot = -0.5 * h * at_rest.body.rddot;
    return of;
}

struct Stiffness {
    double k, h;
};
/// A tenth of what the period of the contact allows
const std::vector<Stiffness> stiffnesses = {{1e5, 5e-3}, {1e6, 1e-3}, {1e7, 2e-4}, {1e8, 5e-5}};

void add_bowl(std::vector<MethodRun>& runs)
{
    constexpr double end = 2, every = 0.1;
    std::vector<double> instants;
    for (int k = 0; k <= std::lround(end / every); ++k) instants.push_back(every * k);
    const auto reference_solution = std::make_shared<const std::vector<reference::ContactInstant>>(
        bowl.slide({.p = bowl.point(1, 1.5)}, instants));
    const auto off = [reference_solution](const Method& m, double t) {
        const double k = t / every;
        if (std::abs(k - std::round(k)) > 1e-6) return 0.;
        return (m.body(1).r - (*reference_solution)[std::lround(k)].body.r).norm();
    };
    const ContactScene of = bowl_with({bowl.point(1, 1.5)});
    const auto add = [&](const std::string& method, double h, double k,
                         std::function<std::unique_ptr<Method>()> make) {
        MethodRun run{.part = "bowl", .method = method, .h = h, .end = end, .stiffness = k};
        run.make = std::move(make), run.error = off;
        runs.push_back(run);
    };
    for (const double h : {2e-2, 1e-2, 5e-3, 2.5e-3, 1e-3, 5e-4}) {
        add("evolving", h, std::nan(""), [=] { return methods::evolving(of, {.reach = 1e-6}); });
        add("evolving, text", h, std::nan(""),
            [=] { return methods::evolving(of, {.scheme = "rA-half-1", .reach = 1e-6}); });
        add("DVI", h, std::nan(""), [=] { return methods::rigid(of, {}); });
        add("DVI, not stabilised", h, std::nan(""),
            [=] { return methods::rigid(of, {.stabilised = false}); });
        add("DVI, text", h, std::nan(""), [=] { return methods::rigid(of, {.half_kick = false}); });
    }
    for (const Stiffness& s : stiffnesses)
        add("DEM", s.h, s.k, [=, at_rest = reference_solution->front()] {
            return methods::springs(leaning(of, at_rest, s.k, s.h), {.stiffness = s.k, .restitution = 1});
        });
}

// ---- many contacts that do not know of each other ----------------------------------------------------------------------

void add_many(std::vector<MethodRun>& runs)
{
    for (const int balls : {1, 10, 100, 1000, 10000}) {
        std::vector<Vec3> touched;
        for (int k = 0; k < balls; ++k) {
            const double angle = 2.399963 * k, r = std::sqrt((k + 0.5) / balls);  // even over the lower bowl
            touched.push_back(bowl.point(2 * r * std::cos(angle), 1.5 * r * std::sin(angle)));
        }
        const ContactScene of = bowl_with(touched);
        const double steps = std::clamp(2e4 / balls, 20., 2000.);
        const auto add = [&](const std::string& method, double h, double k,
                             std::function<std::unique_ptr<Method>()> make) {
            MethodRun run{
                .part = "many", .method = method, .h = h, .end = h * steps, .stiffness = k, .bodies = balls};
            run.make = std::move(make);
            runs.push_back(run);
        };
        add("evolving", 5e-3, std::nan(""), [=] { return methods::evolving(of, {.reach = 1e-6}); });
        add("evolving, KLU", 5e-3, std::nan(""),
            [=] { return methods::evolving(of, {.solver = lie::LinearSolver::klu, .reach = 1e-6}); });
        add("DVI", 5e-3, std::nan(""), [=] { return methods::rigid(of, {}); });
        add("DEM", 1e-3, 1e6, [=] { return methods::springs(of, {.stiffness = 1e6, .restitution = 1}); });
    }
}

// ---- a chain in a groove ------------------------------------------------------------------------------------------------

/// Balls in a row that touch each other in a groove down a slope, held by one that is fixed: at rest, each pressed by all
/// that are above it. Down the slope is -x.
void add_chain(std::vector<MethodRun>& runs)
{
    for (const int balls : {1, 10, 100, 1000, 3333}) {
        RollingChain chain;
        chain.balls = balls, chain.speed = 0, chain.mu_wall = 0;
        ContactScene of = scene(chain);
        contact::BodyType stop = of.kind.back();
        stop.inertia = {};
        of.kind.push_back(stop);
        of.interaction.push_back({"stop", of.body.back().kind, static_cast<int>(of.kind.size()) - 1, 0});
        lie::Motion before_the_first = of.body[2].start;
        before_the_first.r.x() -= 2 * chain.R;
        of.body.push_back({static_cast<int>(of.kind.size()) - 1, before_the_first});
        const auto add = [&](const std::string& method, double h, double k,
                             std::function<std::unique_ptr<Method>()> make) {
            MethodRun run{
                .part = "chain", .method = method, .h = h, .end = 0.05, .stiffness = k, .bodies = balls};
            run.make = std::move(make);
            run.error = [at = of.body, balls](const Method& m, double) {
                double largest = 0;
                for (int b = 2; b < balls + 2; ++b)
                    largest = std::max(largest, (m.body(b).r - at[b].start.r).norm());
                return largest;
            };
            runs.push_back(run);
        };
        add("evolving", 5e-3, std::nan(""), [=] { return methods::evolving(of, {.reach = 1e-6}); });
        add("DVI", 5e-3, std::nan(""),
            [=] { return methods::rigid(of, {.tolerance = 1e-6, .most_iterations = 3000}); });
        add("DEM", 2e-4, 1e6, [=] { return methods::springs(of, {.stiffness = 1e6}); });
    }
}

// ---- a pile ---------------------------------------------------------------------------------------------------------------

void add_pile(std::vector<MethodRun>& runs)
{
    for (const int balls : {2, 4, 8, 16, 32}) {
        Pile pile;
        pile.balls = balls, pile.mu = 0;
        const ContactScene of = scene(pile);
        const auto add = [&](const std::string& method, double h, double k,
                             std::function<std::unique_ptr<Method>()> make) {
            MethodRun run{
                .part = "pile", .method = method, .h = h, .end = 1, .stiffness = k, .bodies = balls};
            run.make = std::move(make);
            runs.push_back(run);
        };
        if (balls <= 4)  // with more, contacts that bear nothing open and close without end
            add("evolving", 2e-3, std::nan(""),
                [=] { return methods::evolving(of, {.reach = 100, .unilateral = true}); });
        add("DVI", 1e-3, std::nan(""),
            [=] { return methods::rigid(of, {.tolerance = 1e-5, .most_iterations = 2000}); });
        add("DEM", 2e-4, 1e6, [=] { return methods::springs(of, {.stiffness = 1e6}); });
    }
}

/// Runs it from the start to the end; the clock stands still while it is judged, and in the first step, which sets up.
void compute(MethodRun& run)
{
    run.steps = std::lround(run.end / run.h);
    try {
        const std::unique_ptr<Method> method = run.make();
        double largest = 0;
        for (long n = 1; n <= run.steps; ++n) {
            const double before = thread_seconds();
            method->step(run.h);
            if (n > 1) run.seconds += thread_seconds() - before;
            if (run.error) largest = std::max(largest, run.error(*method, static_cast<double>(n) * run.h));
        }
        run.seconds *= static_cast<double>(run.steps) / static_cast<double>(std::max(1L, run.steps - 1));
        if (run.error) run.largest_error = largest;
        run.contacts = method->contacts();
        run.iterations = method->iterations();
        run.events = method->events();
    } catch (const lie::NumericalFailure& e) {
        run.status = e.status;
        run.message = e.what();
        run.seconds = run.largest_error = std::nan("");
    }
}

Table as_table(const std::vector<MethodRun>& runs)
{
    std::vector<Table::Column> columns;
    for (const char* name :
         {"part", "method", "h", "stiffness", "bodies", "end", "steps", "contacts", "iterations", "events",
          "error", "cpu_seconds", "us_per_step", "us_per_step_and_contact", "status"})
        columns.push_back({name});
    Table table(columns);
    for (const MethodRun& run : runs)
        table.add({run.part, run.method, run.h, run.stiffness, static_cast<double>(run.bodies), run.end,
                   static_cast<double>(run.steps), static_cast<double>(run.contacts),
                   static_cast<double>(run.iterations), static_cast<double>(run.events), run.largest_error,
                   run.seconds, run.microseconds(), run.of_contact(), run.status});
    return table;
}

void print(const std::vector<MethodRun>& runs, std::ostream& out)
{
    static const std::map<std::string, std::string> title = {
        {"bowl", "A ball slides in a bowl for 2 s: largest error of its position"},
        {"many", "Balls in a bowl, each by itself: cost of a step"},
        {"chain", "Balls in a row in a groove, held by the first, 0.05 s: what moves of what is at rest"},
        {"pile", "Balls that fall into a bowl, 1 s"}};
    for (const std::string& part : parts) {
        Table table({{"method"},
                     {"h [s]", "{:g}"},
                     {"k [N/m]", "{:g}"},
                     {"bodies", "{:.0f}"},
                     {"contacts", "{:.0f}"},
                     {"events", "{:.0f}"},
                     {"iter/step", "{:.1f}"},
                     {"error [m]", "{:.1e}"},
                     {"CPU [ms]", "{:.2f}"},
                     {"us/step/contact", "{:.2f}"},
                     {"status"}});
        for (const MethodRun& run : runs)
            if (run.part == part)
                table.add({run.method, run.h, run.stiffness, static_cast<double>(run.bodies),
                           static_cast<double>(run.contacts), static_cast<double>(run.events),
                           static_cast<double>(run.iterations) / static_cast<double>(run.steps),
                           run.largest_error, 1e3 * run.seconds, run.of_contact(), run.status});
        if (table.rows() == 0) continue;
        out << '\n' << title.at(part) << '\n';
        table.print(out);
    }
}

int contact_methods(const StudyOptions& options)
{
    check_keys(kind, options, std::vector<std::string>{"error"});
    for (const std::string& name : options.problems)
        if (std::find(parts.begin(), parts.end(), name) == parts.end())
            throw UsageError("study contact-methods: unknown part" + with_nearest(name, parts));
    const auto wanted = [&](const std::string& part) {
        return options.problems.empty() ||
               std::find(options.problems.begin(), options.problems.end(), part) != options.problems.end();
    };
    std::vector<MethodRun> runs;
    if (wanted("bowl")) add_bowl(runs);
    if (wanted("many")) add_many(runs);
    if (wanted("chain")) add_chain(runs);
    if (wanted("pile")) add_pile(runs);
    const Pool pool(1, options.quiet ? "" : "contact-methods", static_cast<long>(runs.size()));
    pool.run([&](long k) { compute(runs[k]); });

    StudyOutput output{.kind = kind};
    print(runs, output.text);
    for (const MethodRun& run : runs)
        if (run.status != "ok")
            output.text << fmt::format("{}, {}, {} bodies: {}\n", run.part, run.method, run.bodies,
                                       run.message);
    output.table = as_table(runs).csv();
    output.figures = {};
    for (const std::string& part : parts)
        if (wanted(part)) output.figures.push_back("contact-methods-" + part + ".png");
    std::vector<Measured> came;
    for (const MethodRun& run : runs)
        if (!std::isnan(run.largest_error))
            came.push_back({fmt::format("{} of {} at h = {:g} s", run.method, run.part, run.h),
                            {{"error", run.largest_error}}});
    return finish(options, output, {}, came);
}

const bool registered =
    register_study(Study{.kind = kind,
                         .answers = "evolving contact, DVI and DEM: error against CPU time, cost against "
                                    "number of contacts (Sec. 8.2)",
                         .run = contact_methods});

}  // namespace

}  // namespace hilda::studies
