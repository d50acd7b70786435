// SPDX-License-Identifier: GPL-3.0-or-later
/// Accuracy and cost of three contact methods: evolving contact constraints, rigid contacts as a differential
/// variational inequality (DVI, integrated by rA-moreau-1) and springs (DEM). Fang (2022), Sec. 8.2 names
/// this comparison as future work.
///
/// bowl    A ball slides without friction in the bowl of Sec. 5.5 for 2 s, released at (1, 1.5). Error of the
///         position relative to the solution in minimal coordinates, over CPU time. Except for the variant
///         "text", all methods start with half a kick, so that the differences are caused by the contact
///         method.
/// many    1 to 10000 independent balls in the bowl: CPU time per step and contact.
/// chain   1 to 3333 balls in a row in an inclined groove, supported by a fixed ball, three contacts per
///         ball. The contact forces are coupled through the whole chain. The exact solution is at rest; any
///         motion is an error.
/// pile    Balls fall into a bowl without friction: contacts close and lift off, and the number of contacts
///         may exceed the number of degrees of freedom.

#include "studies/experiments/chapter8/method.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/sweep.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/solver/linear_solver.hpp"
#include "reference/motions/ball_in_bowl.hpp"
#include "run/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

using lie::Vec3;
using methods::Method;

/// One method on one scene at one step
struct MethodRun {
    std::string part, method = {};
    double h = 0, end = 0;
    double stiffness = std::nan("");  ///< of the contact springs [N/m]; NaN without springs
    int bodies = 1;
    std::function<Method()> make = {};
    /// Position error after a step [m]; empty if there is no reference solution
    std::function<double(const Method&, double t)> error = {};

    int contacts = 0, events = 0;
    long steps = 0, iterations = 0;
    double largest_error = std::nan(""), seconds = 0;
    std::string status = "ok", message = {};

    void transfer(io::Archive& a)
    {
        a.value(contacts), a.value(events), a.value(steps), a.value(iterations);
        a.value(largest_error), a.value(seconds), a.list(status), a.list(message);
    }
    double microseconds() const { return 1e6 * seconds / static_cast<double>(steps); }
    double microseconds_per_contact() const { return microseconds() / std::max(1, contacts); }
};

/// Adds the runs of one scene.
struct SceneRuns {
    std::vector<MethodRun>& runs;
    MethodRun scene;   ///< what the runs have in common
    double steps = 0;  ///< number of steps, instead of the end time; 0: the end time

    /// h: step [s], k: stiffness of the contact springs [N/m]
    void add(const std::string& method, double h, double k, std::function<Method()> make)
    {
        MethodRun& run = runs.emplace_back(scene);
        run.method = method, run.h = h, run.stiffness = k, run.make = std::move(make);
        if (steps > 0) run.end = h * steps;
    }
    /// A method without springs
    void add(const std::string& method, double h, std::function<Method()> make)
    {
        add(method, h, std::nan(""), std::move(make));
    }
};

// ---- the bowl of Sec. 5.5 ---------------------------------------------------------------------------------

const reference::BallInBowl bowl;

/// The bowl (body 0) and one ball for each of these contact points on it; the balls start at rest.
ContactScene bowl_scene(const std::vector<Vec3>& contact_points)
{
    ContactScene setup;
    setup.R = bowl.R, setup.m = bowl.m;
    contact::BodyType bowl_type;
    bowl_type.shape = {std::make_shared<contact::Ellipsoid>(bowl.semi_axes, true)};
    setup.body_types = {bowl_type,
                        {.inertia = {bowl.m, bowl.J * lie::Mat3::Identity()},
                         .shape = {std::make_shared<contact::Sphere>(bowl.R)},
                         .reach = bowl.R}};
    setup.interaction = {{"ball-bowl", 1, 0, 0}};
    setup.body = {{0, {}}};
    for (const Vec3& p : contact_points) {
        lie::Motion start;
        start.r = p + bowl.R * bowl.normal(p);
        setup.body.push_back({1, start});
    }
    return setup;
}

/// The same scene with the velocity of the ball at t = -h/2
ContactScene with_half_kick(ContactScene setup, const reference::ContactInstant& at_rest, double h)
{
    setup.body[1].start.rdot = -0.5 * h * at_rest.body.rddot;
    return setup;
}

/// With half a kick, and with the ball pressed into the bowl by the static deflection F_N/k of springs of
/// stiffness k
ContactScene with_static_compression(ContactScene setup, const reference::ContactInstant& at_rest, double k,
                                     double h)
{
    setup.body[1].start.r -= at_rest.F_N / k * at_rest.n;
    return with_half_kick(std::move(setup), at_rest, h);
}

struct StiffnessAndStep {
    double k, h;
};
/// Stiffness k [N/m] and step [s]; the steps are 0.8, 0.5, 0.3 and 0.25 of the stability limit 2 √(m/k) of
/// the contact spring.
const std::vector<StiffnessAndStep> stiffnesses = {{1e5, 5e-3}, {1e6, 1e-3}, {1e7, 2e-4}, {1e8, 5e-5}};

void add_bowl(std::vector<MethodRun>& runs)
{
    constexpr double end = 2, interval = 0.1;
    std::vector<double> instants;
    for (int k = 0; k <= std::lround(end / interval); ++k) instants.push_back(interval * k);
    const auto reference_solution = std::make_shared<const std::vector<reference::ContactInstant>>(
        bowl.slide({.p = bowl.point(1, 1.5)}, instants));
    const auto position_error = [reference_solution](const Method& m, double t) {
        const double k = t / interval;
        if (std::abs(k - std::round(k)) > 1e-6) return 0.;
        return (m.body(1).r - (*reference_solution)[std::lround(k)].body.r).norm();
    };
    const ContactScene setup = bowl_scene({bowl.point(1, 1.5)});
    SceneRuns bowl_runs{runs, {.part = "bowl", .end = end, .error = position_error}};
    for (const double h : {2e-2, 1e-2, 5e-3, 2.5e-3, 1e-3, 5e-4}) {
        bowl_runs.add("evolving", h, [=] { return methods::evolving(setup, {.reach = 1e-6}); });
        bowl_runs.add("evolving, text", h,
                      [=] { return methods::evolving(setup, {.scheme = "rA-half-1", .reach = 1e-6}); });
        bowl_runs.add("DVI", h, [=, at_rest = reference_solution->front()] {
            return methods::dvi(with_half_kick(setup, at_rest, h));
        });
    }
    for (const StiffnessAndStep& s : stiffnesses)
        bowl_runs.add("DEM", s.h, s.k, [=, at_rest = reference_solution->front()] {
            return methods::compliant_springs(with_static_compression(setup, at_rest, s.k, s.h),
                                              {.stiffness = s.k, .restitution = 1});
        });
}

// ---- many independent contacts ----------------------------------------------------------------------------

void add_many(std::vector<MethodRun>& runs)
{
    for (const int balls : {1, 10, 100, 1000, 10000}) {
        std::vector<Vec3> contact_points;
        for (int k = 0; k < balls; ++k) {
            const double angle = 2.399963 * k,
                         r = std::sqrt((k + 0.5) / balls);  // uniform over the lower part
            contact_points.push_back(bowl.point(2 * r * std::cos(angle), 1.5 * r * std::sin(angle)));
        }
        const ContactScene setup = bowl_scene(contact_points);
        SceneRuns scene_runs{runs, {.part = "many", .bodies = balls}, std::clamp(2e4 / balls, 20., 2000.)};
        scene_runs.add("evolving", 5e-3, [=] { return methods::evolving(setup, {.reach = 1e-6}); });
        scene_runs.add("evolving, KLU", 5e-3, [=] {
            return methods::evolving(setup, {.solver = lie::LinearSolver::klu, .reach = 1e-6});
        });
        scene_runs.add("DVI", 5e-3, [=] { return methods::dvi(setup); });
        scene_runs.add("DEM", 1e-3, 1e6, [=] {
            return methods::compliant_springs(setup, {.stiffness = 1e6, .restitution = 1});
        });
    }
}

// ---- a chain in a groove ----------------------------------------------------------------------------------

/// Balls in contact with each other in an inclined groove, supported by a fixed ball at the lower end. All
/// balls are at rest; each carries the weight component of all balls above it. -x points down the slope.
void add_chain(std::vector<MethodRun>& runs)
{
    for (const int balls : {1, 10, 100, 1000, 3333}) {
        RollingChain chain;
        chain.balls = balls, chain.speed = 0, chain.mu_wall = 0;
        ContactScene setup = scene(chain);
        contact::BodyType stop = setup.body_types.back();
        stop.inertia = {};
        setup.body_types.push_back(stop);
        setup.interaction.push_back(
            {"stop", setup.body.back().type, static_cast<int>(setup.body_types.size()) - 1, 0});
        lie::Motion stop_start = setup.body[2].start;
        stop_start.r.x() -= 2 * chain.R;
        setup.body.push_back({static_cast<int>(setup.body_types.size()) - 1, stop_start});
        const auto displacement = [at = setup.body, balls](const Method& m, double) {
            double largest = 0;
            for (int b = 2; b < balls + 2; ++b)
                largest = std::max(largest, (m.body(b).r - at[b].start.r).norm());
            return largest;
        };
        SceneRuns scene_runs{runs, {.part = "chain", .end = 0.05, .bodies = balls, .error = displacement}};
        scene_runs.add("evolving", 5e-3, [=] { return methods::evolving(setup, {.reach = 1e-6}); });
        scene_runs.add("DVI", 5e-3, [=] { return methods::dvi(setup); });
        scene_runs.add("DEM", 2e-4, 1e6,
                       [=] { return methods::compliant_springs(setup, {.stiffness = 1e6}); });
    }
}

// ---- a pile -----------------------------------------------------------------------------------------------

void add_pile(std::vector<MethodRun>& runs)
{
    for (const int balls : {2, 4, 8, 16, 32}) {
        Pile pile;
        pile.balls = balls, pile.mu = 0;
        const ContactScene setup = scene(pile);
        SceneRuns scene_runs{runs, {.part = "pile", .end = 1, .bodies = balls}};
        if (balls <= 4)  // with more balls, contacts without load open and close indefinitely
            scene_runs.add("evolving", 2e-3,
                           [=] { return methods::evolving(setup, {.reach = 100, .unilateral = true}); });
        scene_runs.add("DVI", 1e-3, [=] { return methods::dvi(setup); });
        scene_runs.add("DEM", 2e-4, 1e6,
                       [=] { return methods::compliant_springs(setup, {.stiffness = 1e6}); });
    }
}

/// A scene with its runs
struct Part {
    std::string name, title;
    void (*add)(std::vector<MethodRun>& runs);
};
const std::vector<Part> parts = {
    {"bowl", "Ball sliding in a bowl for 2 s: largest position error", add_bowl},
    {"many", "Independent balls in a bowl: CPU time per step", add_many},
    {"chain", "Chain of balls at rest in an inclined groove, 0.05 s: largest displacement", add_chain},
    {"pile", "Balls falling into a bowl, 1 s", add_pile}};

/// Runs one method from start to end. The measured time excludes the error evaluation and the first step,
/// which allocates and sets up.
void compute(MethodRun& run)
{
    run.steps = std::lround(run.end / run.h);
    run.seconds = run.largest_error = std::nan("");
    const Method method = run.make();
    double largest = 0, seconds = 0;
    for (long n = 1; n <= run.steps; ++n) {
        const double before = run::thread_seconds();
        method.step(run.h);
        if (n > 1) seconds += run::thread_seconds() - before;
        if (run.error) largest = std::max(largest, run.error(method, static_cast<double>(n) * run.h));
    }
    run.seconds = seconds * static_cast<double>(run.steps) / static_cast<double>(std::max(1L, run.steps - 1));
    if (run.error) run.largest_error = largest;
    run.contacts = method.contacts();
    run.iterations = method.iterations();
    run.events = method.events();
}

const Columns<MethodRun> columns = {
    {"part", &MethodRun::part},
    {"method", "method", &MethodRun::method},
    {"h", "h [s]", "{:g}", &MethodRun::h},
    {"stiffness", "k [N/m]", "{:g}", &MethodRun::stiffness},
    {"bodies", "bodies", "{:.0f}", &MethodRun::bodies},
    {"end", &MethodRun::end},
    {"steps", &MethodRun::steps},
    {"contacts", "contacts", "{:.0f}", &MethodRun::contacts},
    {"", "events", "{:.0f}", &MethodRun::events},
    {"iterations", &MethodRun::iterations},
    {"events", &MethodRun::events},
    {"", "iter/step", "{:.1f}",
     [](const auto& run) { return static_cast<double>(run.iterations) / static_cast<double>(run.steps); }},
    {"error", "error [m]", "{:.1e}", &MethodRun::largest_error},
    {"", "CPU [ms]", "{:.2f}", [](const auto& run) { return 1e3 * run.seconds; }},
    {"cpu_seconds", &MethodRun::seconds},
    {"us_per_step", &MethodRun::microseconds},
    {"us_per_step_and_contact", "us/step/contact", "{:.2f}", &MethodRun::microseconds_per_contact},
    {"status", "status", &MethodRun::status}};

void contact_methods(StudyContext& s)
{
    const std::vector<const Part*> selected = selected_parts(s, "part", parts);
    Sweep<MethodRun> runs;
    for (const Part* part : selected) part->add(runs);
    runs.compute_in_turn(s, compute);

    for (const Part* part : selected) {
        s.text << '\n' << part->title << '\n';
        columns.print(s.text, those(runs, [&](const MethodRun& run) { return run.part == part->name; }));
        s.figures.push_back(s.name + '-' + part->name + ".png");
    }
    for (const MethodRun& run : runs) {
        if (run.status != "ok")
            s.text << fmt::format("{}, {}, {} bodies: {}\n", run.part, run.method, run.bodies, run.message);
        if (!std::isnan(run.largest_error))
            s.measured.push_back({fmt::format("{} of {} at h = {:g} s", run.method, run.part, run.h),
                                  {{"error", run.largest_error}}});
    }
    s.table = columns.csv(runs);
    std::vector<Criterion> checks;
    for (const MethodRun& run : runs)
        if (run.part == "bowl" && run.method == "evolving" && run.h == 1e-2)
            checks.push_back(between("position error of evolving contact, bowl, h = 0.01 s [m]",
                                     run.largest_error, 0, 1e-4));
    if (s.check) s.evaluate(checks);
}

const bool registered_contact_methods = io::Registry<Study>::add(
    {.name = "contact-methods",
     .answers = "evolving contact, DVI and DEM: error against CPU time, cost against "
                "number of contacts (Sec. 8.2)",
     .options = {"--problem", "--check"},
     .keys = {"error"},
     .files = {"contact-methods-PART.png"},
     .run = contact_methods});

}  // namespace

}  // namespace hilda::studies
