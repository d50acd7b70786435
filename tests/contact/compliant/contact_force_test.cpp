// SPDX-License-Identifier: GPL-3.0-or-later
// ContactForce in a model: the loads are a function of the state, with all integrators.
#include <catch2/catch.hpp>

#include "contact/compliant/contact_force.hpp"
#include "contact/scenes/scene.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/euler_parameters.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/contact/compliant/slide_roll_spin.hpp"
#include "tests/support/no_allocation.hpp"

using namespace hilda;
using namespace hilda::contact;
using lie::State;
using tests::slide_roll_spin;

namespace {

constexpr double m = 5, R = 0.2, N = m * 9.81, k = 2e5;

FrictionParameters rubber()
{
    return {.mu_s = 0.25,
            .mu_k = 0.2,
            .K_E = 2e4,
            .zeta = 0.5,
            .eta_r = 0.05,
            .eta_psi = 0.05,
            .static_start = false};  // as a scene starts
}

std::shared_ptr<const NormalLaw> spring() { return std::make_shared<Hooke>(Hooke::with_restitution(k, 0.5)); }

Inertia ball_inertia() { return {.m = m, .J_bar = 0.4 * m * R * R * Mat3::Identity()}; }
Shape ball_surface(double radius = R) { return {.surface = std::make_shared<Sphere>(radius)}; }
Shape floor() { return {.surface = std::make_shared<Plane>()}; }

/// A ball sliding along x with a spin about the vertical; the overlap carries its weight
Motion thrown(double v, double spin = 3)
{
    Motion b;
    b.r = {0, 0, R - N / k};
    b.rdot = {v, 0.1 * v, 0};
    b.omega_bar = {0, 0, spin};
    return b;
}
/// A rolling ball; its angular velocity is multiplied by `factor`
Motion rolling(double v, double factor = 1)
{
    Motion b = thrown(v, 1);
    b.omega_bar.head<2>() = factor * v / R * Eigen::Vector2d(-0.1, 1);
    return b;
}

struct OneBall {
    dae::Model model;
    State x;

    explicit OneBall(const Motion& start, const FrictionParameters& p = rubber())
    {
        model.add({.name = "ball", .m = m, .J_bar = ball_inertia().J_bar});
        x.body = {start};
        model.load(std::make_unique<ContactForce>("ball-floor", model, 0, ball_surface(), dae::ground,
                                                  floor(), spring(), slide_roll_spin(p)));
        dae::start(model, x);
    }
    const ContactForce& contact() const { return dynamic_cast<const ContactForce&>(*model.forces().front()); }
    State after(const std::string& scheme, double t, double h) const
    {
        const auto integrator = lie::scheme(scheme).make(model, {});
        lie::March march(x, *integrator, h);
        for (long n = std::lround(t / h); n > 0; --n) march.advance({});
        return march.node();
    }
};

double distance(const Motion& a, const Motion& b)
{
    return (a.r - b.r).norm() + (a.rdot - b.rdot).norm() + R * (a.A - b.A).norm() +
           R * (a.omega_bar - b.omega_bar).norm();
}

lie::Loads loads(const dae::Model& model, const State& x)
{
    lie::Loads out(model.bodies());
    model.loads(x, out);
    return out;
}

bool same(const State& a, const State& b)
{
    bool all = a.t == b.t && a.discrete_state == b.discrete_state && a.internal_state == b.internal_state;
    for (size_t n = 0; n < a.body.size(); ++n)
        all = all && a.body[n].r == b.body[n].r && a.body[n].A == b.body[n].A &&
              a.body[n].rdot == b.body[n].rdot && a.body[n].omega_bar == b.body[n].omega_bar;
    return all;
}

}  // namespace

TEST_CASE("the motion of a ball in a model and in a scene converges to the same solution (long)",
          "[contact][force]")
{
    const auto apart = [](double h, const Motion& start) {
        const OneBall one(start);
        Scene scene;
        scene.add(ball_inertia(), start);
        scene.add({}, {});
        scene.add("ball-floor", 0, ball_surface(), 1, floor(), spring(), slide_roll_spin(rubber()));
        for (long n = std::lround(0.5 / h); n > 0; --n) scene.step(h);
        return distance(one.after("rA-half-1", 0.5, h).body[0], scene.body[0]);
    };
    for (const Motion& start : {thrown(2), rolling(1, 0.98)}) {
        const double a = apart(4e-4, start), b = apart(2e-4, start), c = apart(1e-4, start);
        INFO(a << ' ' << b << ' ' << c);
        CHECK(c < 1e-3);
        CHECK(std::log2(a / c) / 2 == Approx(1).margin(0.2));
    }
}

TEST_CASE("the loads of a contact are a function of the state", "[contact][force]")
{
    const OneBall one(thrown(2));
    State x = one.after("rA-half-1", 0.01, 1e-4);
    const State before = x;
    const lie::Loads first = loads(one.model, x), second = loads(one.model, x);
    CHECK(first.F[0] == second.F[0]);
    CHECK(first.n_bar[0] == second.n_bar[0]);
    CHECK(same(x, before));

    // the loads of another state do not change those of x
    State other = x;
    other.t += 1e-3;
    other.body[0].r += Vec3(1e-3, 0, 0);
    loads(one.model, other);
    CHECK(loads(one.model, x).F[0] == first.F[0]);

    // a step that fails does not change the state
    const auto hasty = lie::scheme("rA-full-1").make(one.model, {.max_iterations = 1});
    CHECK_THROWS_AS(hasty->step(x, 1e-4), lie::NoConvergence);
    CHECK(same(x, before));
    const auto fine = lie::scheme("rA-half-1").make(one.model, {}),
               again = lie::scheme("rA-half-1").make(one.model, {});
    State y = before;
    fine->step(x, 1e-4);
    again->step(y, 1e-4);
    CHECK(same(x, y));
}

TEST_CASE("a slipping contact remains slipping if the pose changes by rounding only", "[contact][force]")
{
    const OneBall one(thrown(2));
    State x = one.after("rA-half-1", 0.05, 1e-4);
    const ContactHistory history = one.contact().saved_history(x);
    REQUIRE(history.deflections.slide.slipping);
    const double pressed = one.contact().at(x).contact_state.N, most = rubber().mu_k * pressed;
    CHECK(one.contact().friction(x).F.norm() == Approx(most).epsilon(1e-12));

    // conversion to Euler parameters and back
    lie::Motion& b = x.body[0];
    b.A = lie::rotation(lie::euler_parameters(b.A));
    b.r += Vec3(1, -1, 0) * 1e-16;
    CHECK(one.contact().friction(x).F.norm() == Approx(most).epsilon(1e-9));
    State accepted = x;
    one.model.accepted(x, accepted);
    CHECK(one.contact().saved_history(accepted).deflections.slide.slipping);
    // a displacement above rounding against the direction of slip leads to stick
    x.body[0].r -= 1e-9 * x.body[0].rdot;
    CHECK(!one.contact().at(x).history.deflections.slide.slipping);
}

TEST_CASE("an impact of two free bodies conserves linear and angular momentum", "[contact][force]")
{
    dae::Model model;
    model.gravity.setZero();
    const double J = 0.4 * 2 * 0.01;
    model.add({.name = "a", .m = 2, .J_bar = J * Mat3::Identity()});
    model.add({.name = "b", .m = 0.5, .J_bar = 0.3 * J * Mat3::Identity()});
    model.load(std::make_unique<ContactForce>("a-b", model, 0, ball_surface(0.1), 1, ball_surface(0.05),
                                              std::make_shared<Hertz>(1e6, 0.8), slide_roll_spin(rubber())));
    State x;
    x.body.resize(2);
    x.body[0].rdot = {1, 0.2, 0}, x.body[0].omega_bar = {3, -5, 20};
    x.body[1].r = {0.151, 0.02, 0.01}, x.body[1].rdot = {-1, 0, 0.3}, x.body[1].omega_bar = {0, 7, 1};
    dae::start(model, x);
    const auto momentum = [&](const State& s) {
        Eigen::Matrix<double, 6, 1> p = Eigen::Matrix<double, 6, 1>::Zero();
        for (int b = 0; b < 2; ++b) {
            const Motion& body = s.body[b];
            const Vec3 mv = model.mass().m[b] * body.rdot;
            p.head<3>() += mv;
            p.tail<3>() += body.r.cross(mv) + body.A * (model.mass().J_bar[b] * body.omega_bar);
        }
        return p;
    };
    const auto before = momentum(x);
    const auto integrator = lie::scheme("rA-half-1").make(model, {});
    const auto& contact = dynamic_cast<const ContactForce&>(*model.forces()[0]);
    bool touched = false;
    lie::March march(x, *integrator, 1e-5);
    for (int n = 0; n < 4000; ++n) {
        march.advance({});
        touched = touched || contact.saved_history(march.node()).touching;
    }
    CHECK(touched);
    CHECK(!contact.saved_history(march.node()).touching);  // the bodies have separated
    CHECK((march.node().body[1].rdot - x.body[1].rdot).norm() > 1);
    CHECK((momentum(march.node()) - before).norm() < 1e-12);
}

TEST_CASE("all integrators converge to the same position of a rolling ball (long)", "[contact][force][order]")
{
    const FrictionParameters sticking{.mu_s = 0.25, .mu_k = 0.25, .K_E = 2e4, .zeta = 0.5};
    const OneBall one(rolling(1, 0.98), sticking);
    const State reference = one.after("rA-rkmk-4", 0.1, 1e-5);
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::history)) continue;
        const double a = distance(one.after(s.name, 0.1, 5e-4).body[0], reference.body[0]),
                     b = distance(one.after(s.name, 0.1, 2.5e-4).body[0], reference.body[0]);
        INFO(s.name << " declares " << s.order << ", errors " << a << ' ' << b);
        CHECK(b < (s.order == 1 ? 5e-6 : 1e-7));
        CHECK(std::log2(a / b) > std::min(s.order, 2) - 0.3);
    }
}

TEST_CASE("the dampers are active from the beginning of contact", "[contact][force]")
{
    const FrictionParameters p{.mu_s = 0.25, .mu_k = 0.25, .K_E = 2e4, .zeta = 0.5};
    const OneBall one(rolling(1, 0.98), p);
    const double D = 2 * p.zeta * std::sqrt(m * p.K_E);
    CHECK(one.contact().friction(one.x).F.norm() == Approx(D * 0.02 * std::hypot(1, 0.1)).epsilon(1e-3));
}

TEST_CASE("a contact does not allocate memory", "[contact][force][allocation]")
{
    const OneBall one(thrown(2));
    State x = one.x;
    lie::Loads out(1);
    const long taken = tests::allocations_during([&] {
        for (int n = 0; n < 3; ++n) {
            x.t += 1e-4;
            x.body[0].r += 1e-4 * x.body[0].rdot;
            one.contact().add(x, out);
            one.contact().update_internal_state(x);
            one.contact().potential_energy(x);
        }
    });
    if (tests::counts_allocations) CHECK(taken == 0);
}

TEST_CASE("the contact point is found once per node", "[contact][force]")
{
    /// A sphere that counts the calls of support(), one for each detection of the contact with a plane
    struct CountedSphere final : Surface {
        double value(const Vec3& a) const override { return sphere.value(a); }
        Vec3 gradient(const Vec3& a) const override { return sphere.gradient(a); }
        Mat3 hessian(const Vec3& a) const override { return sphere.hessian(a); }
        bool convex() const override { return true; }
        std::optional<Vec3> support(const Vec3& u) const override
        {
            ++detections;
            return sphere.support(u);
        }
        double size() const override { return R; }

        const Sphere sphere = Sphere(R);
        mutable long detections = 0;
    };
    const auto surface = std::make_shared<CountedSphere>();
    dae::Model model;
    model.add({.name = "ball", .m = m, .J_bar = ball_inertia().J_bar});
    model.load(std::make_unique<ContactForce>("ball-floor", model, 0, Shape{.surface = surface}, dae::ground,
                                              floor(), spring(), slide_roll_spin(rubber())));
    State x;
    x.body = {thrown(2)};
    dae::start(model, x);
    const auto integrator = lie::scheme("rA-half-1").make(model, {});
    lie::March march(x, *integrator, 1e-4);
    const long before = surface->detections;
    constexpr int steps = 100;
    for (int n = 0; n < steps; ++n) {
        march.advance({});
        model.potential_energy(march.node());
    }
    // the march is up to one step ahead of its node
    CHECK(surface->detections - before >= steps);
    CHECK(surface->detections - before <= steps + 1);
}

TEST_CASE("the stability limit is estimated before the bodies are in contact", "[contact][force]")
{
    const OneBall resting(thrown(0));
    Motion high = thrown(0);
    high.r.z() += 0.1;
    const OneBall falling(high);
    const double h = resting.model.stable_step(resting.x).h;
    CHECK(h > 1e-3);
    CHECK(h < 0.01);
    CHECK(falling.model.stable_step(falling.x).h == Approx(h).epsilon(1e-3));

    // the stiffness of a Hertzian contact increases with the speed of the impact
    const auto bound = [](double height, double overlap) {
        dae::Model model;
        model.add({.name = "ball", .m = m, .J_bar = ball_inertia().J_bar});
        model.load(std::make_unique<ContactForce>("c", model, 0, ball_surface(), dae::ground, floor(),
                                                  std::make_shared<Hertz>(1e8), frictionless()));
        State x;
        x.body.resize(1);
        x.body[0].r.z() = R + height - overlap;
        dae::start(model, x);
        return model.stable_step(x).h;
    };
    // energy balance: 4/15 S δ² = m g (height + δ), S = 2 E* √(R δ); ω² = S/m and h = 2/ω
    const double deepest = std::pow(N * 0.1 / (8. / 15 * 1e8 * std::sqrt(R)), 0.4);
    CHECK(bound(0.1, 0) == Approx(2 / std::sqrt(2e8 * std::sqrt(R * deepest) / m)).epsilon(1e-2));
    CHECK(bound(0, 1e-9) > bound(0.01, 0));
    CHECK(bound(0.01, 0) > bound(0.1, 0));
}

TEST_CASE("a step is stable up to the stability limit", "[contact][force]")
{
    const OneBall resting(thrown(0));
    const dae::Force& force = *resting.model.forces()[0];
    const auto is_stable = [](const OneBall& ball, double h, lie::LoadEvaluation evaluation) {
        std::vector<int> touching;
        ball.model.count_contacts(ball.x, dae::Force::Counted::touching, touching);
        return ball.model.forces()[0]->is_stable(ball.x, h, evaluation, touching);
    };
    for (const auto evaluation : {lie::LoadEvaluation::at_step, lie::LoadEvaluation::extrapolated}) {
        const double h = force.stable_step(resting.x, evaluation);
        CHECK(is_stable(resting, 0.999 * h, evaluation));
        CHECK_FALSE(is_stable(resting, 1.001 * h, evaluation));
        CHECK(is_stable(resting, 1e-3 * h, evaluation));
    }
    CHECK(force.stable_step(resting.x, lie::LoadEvaluation::extrapolated) <
          0.8 * force.stable_step(resting.x));
    Motion above = thrown(0);
    above.r.z() += 0.1;
    const OneBall falling(above);
    CHECK(is_stable(falling, 1, lie::LoadEvaluation::at_step));  // apart: no stiffness now
}

TEST_CASE("the stability limit is that of symplectic Euler and of leapfrog with extrapolated velocities",
          "[contact][force]")
{
    // A ball on its static overlap, without friction and with a damped contact. A deviation grows above the
    // limit.
    const double zeta = 0.7, c = 2 * zeta * std::sqrt(k * m);
    dae::Model model;
    model.add({.name = "ball", .m = m, .J_bar = ball_inertia().J_bar});
    model.load(std::make_unique<ContactForce>("c", model, 0, ball_surface(), dae::ground, floor(),
                                              std::make_shared<Hooke>(k, c), frictionless()));
    State start;
    start.body.resize(1);
    start.body[0].r.z() = R - N / k;
    dae::start(model, start);
    start.body[0].r.z() += 1e-6 * N / k;
    const auto deviation = [&](const char* scheme, double h) {
        const auto integrator = lie::scheme(scheme).make(model, {});
        const State end = lie::march(start, *integrator, lie::TimeGrid::over(200 * h, h)).row.back();
        return std::abs(end.body[0].r.z() - (R - N / k)) / (1e-6 * N / k);
    };
    for (const char* scheme : {"rA-half-1", "rA-half-1-kick"}) {
        CAPTURE(scheme);
        const double h = model.forces()[0]->stable_step(start, lie::scheme(scheme).loads);
        CHECK(deviation(scheme, 0.97 * h) < 1);
        CHECK(deviation(scheme, 1.03 * h) > 100);
    }
}

TEST_CASE("the springs of friction store the work of the friction force", "[contact][force]")
{
    // A ball pressed on the floor by its weight is moved along x without rotation: stick up to mu N / K_E
    OneBall pushed(thrown(0, 0));
    const dae::Force& force = *pushed.model.forces()[0];
    CHECK(force.internal_energy(pushed.x) == 0);
    const double K_E = rubber().K_E, d = 1e-5;
    State x = pushed.x;
    x.body[0].r.x() += d;
    x.t += 1e-3;
    force.update_internal_state(x);
    CHECK(force.internal_energy(x) == Approx(0.5 * K_E * d * d).epsilon(1e-3));
    for (int n = 0; n < 200; ++n) {  // 2 mm: slips, the spring remains at its bound
        x.body[0].r.x() += d;
        x.t += 1e-3;
        force.update_internal_state(x);
    }
    const double bound = rubber().mu_k * N;
    CHECK(force.internal_energy(x) == Approx(0.5 * bound * bound / K_E).epsilon(1e-3));
    State rolled = pushed.x;  // rotation in place: the springs of sliding and of rolling, Sec. 4.3
    rolled.body[0].A = lie::exp(Vec3(0, 0, 1e-3));
    rolled.t += 1e-3;
    force.update_internal_state(rolled);
    lie::Loads loads(1);
    force.add(rolled, loads);
    CHECK(force.internal_energy(rolled) > 0);
}

TEST_CASE("the message of a failed detection has the names of the bodies and the time", "[contact][force]")
{
    dae::Model model;
    model.add({.name = "left", .m = 1, .J_bar = Mat3::Identity()});
    model.add({.name = "right", .m = 1, .J_bar = Mat3::Identity()});
    model.load(std::make_unique<ContactForce>("pair", model, 0, ball_surface(), 1, ball_surface(), spring(),
                                              frictionless()));
    State x;
    x.body.resize(2);
    CHECK_THROWS_WITH(dae::start(model, x),
                      Catch::StartsWith("contact 'pair': the centres of two spheres coincide"));
    x.body[1].r.x() = 0.3;
    CHECK_THROWS_WITH(dae::start(model, x),
                      Catch::StartsWith("contact 'pair': the surfaces must not overlap"));
    x.body[1].r.x() = 0.5;
    dae::start(model, x);
    x.t = 0.25;
    x.body[1].r.x() = 0;
    CHECK_THROWS_WITH(loads(model, x),
                      Catch::StartsWith("contact 'pair': the centres of two spheres coincide") &&
                          Catch::EndsWith("; bodies 'left', 'right', t = 0.25 s"));
    CHECK_THROWS_WITH(
        ContactForce("c", model, 1, ball_surface(), 1, ball_surface(), spring(), frictionless()),
        Catch::Contains("two different bodies, got 'right' twice"));
}

TEST_CASE("laws that need curvature are rejected if the surfaces have none", "[contact][force]")
{
    const auto why = [](std::shared_ptr<const NormalLaw> law,
                        std::shared_ptr<const FrictionModel> law_of_friction, Shape shape) {
        const CompliantContact c("c", std::move(shape), floor(), ball_inertia(), {}, std::move(law),
                                 std::move(law_of_friction));
        Motion on;
        on.r.z() = R;
        return c.start_error(on, {});
    };
    const Shape foot{.surface = std::make_shared<Foot>(), .position = {0, 0, -R}};
    const std::string curve = "the sum of the curvatures must be positive, got 0";
    const auto slide = slide_roll_spin({.mu_s = 0.3, .K_E = 1e4});
    CHECK(why(spring(), slide_roll_spin(rubber()), ball_surface()).empty());
    CHECK(why(spring(), slide, foot).empty());
    CHECK(why(spring(), frictionless(), foot).empty());
    CHECK_THAT(why(std::make_shared<Hertz>(1e6), slide, foot), Catch::Contains(curve));
    for (FrictionParameters p : {rubber(), FrictionParameters{.K_E = 1, .eta_psi = 0.1},
                                 FrictionParameters{.K_E = 1, .E_star = 1e6}})
        CHECK_THAT(why(spring(), slide_roll_spin(p), foot), Catch::Contains(curve));
    for (const char* law : {"constant-torque", "epsd"}) {
        CHECK_THAT(why(spring(), friction_law(law).make({.K_E = 1, .mu_r = 0.1}), foot),
                   Catch::Contains(curve));
        CHECK(why(spring(), friction_law(law).make({.K_E = 1}), foot).empty());
    }
}
