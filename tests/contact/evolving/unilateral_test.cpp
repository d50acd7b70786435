// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/unilateral.hpp"
#include "contact/compliant/contact_force.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/gravity.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using contact::ContactEvent;
using contact::EvolvingContact;
using contact::Shape;
using contact::Unilateral;
using lie::Mat3;
using lie::State;
using lie::Vec3;
using tests::g;

namespace {

const Shape plane{std::make_shared<contact::Plane>()};
Shape ball_of_radius(double R) { return {std::make_shared<contact::Sphere>(R)}; }

/// A ball of mass m with a contact to the ground
struct Ball {
    dae::Model model;
    State x;

    Ball(double R, double m, const Shape& ground, const Vec3& r, const Vec3& v, const Unilateral& unilateral,
         EvolvingContact::Friction friction = EvolvingContact::Friction::none,
         const Vec3& omega = Vec3::Zero())
    {
        model.add({"ball", m, 0.4 * m * R * R * Mat3::Identity()});
        model.constrain("contact",
                        std::make_unique<EvolvingContact>(0, ball_of_radius(R), dae::ground, ground, friction,
                                                          EvolvingContact::NormalRows::tangent, unilateral));
        x.body.resize(1);
        x.body[0].r = r, x.body[0].rdot = v, x.body[0].omega_bar = omega;
        dae::start(model, x);
    }
};

struct BounceRun {
    std::vector<State> node;
    std::vector<ContactEvent> events;
};

BounceRun bounce(const Ball& ball, const std::string& scheme, double end, double h)
{
    contact::UnilateralStep step(ball.model, lie::scheme(scheme), {.tolerance = 1e-13});
    BounceRun out;
    out.node = lie::march(ball.x, step, lie::TimeGrid::over(end, h)).row;
    out.events = step.events();
    return out;
}

}  // namespace

TEST_CASE("a ball bounces far from the origin as it does at the origin", "[contact][unilateral]")
{
    const double R = 0.1, height = 0.5;
    const BounceRun here = bounce({R, 2, plane, Vec3(0, 0, R + height), Vec3(0.7, 0.1, 0), {true, 0.8}},
                                  "rA-half-1-momentum", 2, 0.013),
                    far = bounce({R, 2, plane, Vec3(1e4, -3e4, R + height), Vec3(0.7, 0.1, 0), {true, 0.8}},
                                 "rA-half-1-momentum", 2, 0.013);
    REQUIRE(here.events.size() == far.events.size());
    for (size_t k = 0; k < here.events.size(); ++k)
        CHECK(far.events[k].t == Approx(here.events[k].t).epsilon(1e-9));
}

TEST_CASE("a ball bounces at the times of the closed form", "[contact][unilateral]")
{
    const double R = 0.1, height = 0.5, e = 0.8;
    using Impact = Unilateral::Impact;
    for (const Impact impact : {Impact::newton, Impact::poisson})
        for (const char* scheme : {"rA-half-1-momentum", "rA-half-1-kick", "rA-rattle", "rA-rkmk-4"}) {
            INFO(scheme);
            const Ball b(R, 2, plane, Vec3(0.3, 0, R + height), Vec3(0.7, 0.1, 0), {true, e, impact});
            const BounceRun r = bounce(b, scheme, 1.6, 0.013);
            double t = std::sqrt(2 * height / g), v = g * t;
            REQUIRE(r.events.size() >= 3);
            for (int k = 0; k < 3; ++k) {
                CHECK(r.events[k].type == ContactEvent::Type::impact);
                CHECK(r.events[k].t == Approx(t).epsilon(1e-11));
                CHECK(r.events[k].speed == Approx(v).epsilon(1e-11));
                v *= e;
                t += 2 * v / g;
            }
            for (const State& x : r.node) CHECK(x.body[0].r.z() >= R - 1e-12);
            CHECK(r.node.back().body[0].r.x() == Approx(0.3 + 0.7 * r.node.back().t).epsilon(1e-13));
        }
}

TEST_CASE("the impact of one body without friction is the same by Newton's and by Poisson's law",
          "[contact][unilateral]")
{
    // The normal does not point to the centre of mass, and the body frame differs from the global one.
    using Impact = Unilateral::Impact;
    const auto after = [](Impact impact, size_t& events) {
        dae::Model model;
        const double m = 2;
        model.add({"stone", m, m * Vec3(0.017, 0.0225, 0.0305).asDiagonal()});
        const Shape stone{std::make_shared<contact::Ellipsoid>(Vec3(0.3, 0.25, 0.15))};
        model.constrain("contact", std::make_unique<EvolvingContact>(
                                       0, stone, dae::ground, plane, EvolvingContact::Friction::none,
                                       EvolvingContact::NormalRows::tangent, Unilateral{true, 0.6, impact}));
        State x;
        x.body.resize(1);
        x.body[0].r = {0, 0, 0.5}, x.body[0].A = lie::exp(Vec3(0.7, -0.4, 0.9));
        x.body[0].omega_bar = {0.5, -1, 0.3};
        dae::start(model, x);
        contact::UnilateralStep step(model, lie::scheme("rA-half-1-momentum"), {.tolerance = 1e-13});
        State end = lie::march(x, step, lie::TimeGrid::over(0.4, 1e-2)).row.back();
        events = step.events().size();
        return end;
    };
    size_t of_newton = 0, of_poisson = 0;
    const lie::Motion a = after(Impact::newton, of_newton).body[0],
                      b = after(Impact::poisson, of_poisson).body[0];
    CHECK(of_newton >= 1);
    CHECK(of_newton == of_poisson);
    CHECK((a.omega_bar - Vec3(0.5, -1, 0.3)).norm() > 1);  // the impact turns the body
    CHECK((a.rdot - b.rdot).norm() < 1e-9);
    CHECK((a.omega_bar - b.omega_bar).norm() < 1e-9);
    CHECK((a.r - b.r).norm() < 1e-9);
    CHECK((a.A - b.A).norm() < 1e-9);
}

TEST_CASE("a ball leaves a sphere at the angle of the closed form with second order (long)",
          "[contact][unilateral]")
{
    // Sliding: m v²/(R + r) = m g cos θ and v² = v0² + 2 g (R + r)(1 - cos θ). Rolling: 0.7 v² in place of ½
    // v².
    const double R = 1, r = 0.3, v0 = 0.2, d = R + r;
    for (const bool rolling : {false, true}) {
        const double cosine = rolling ? (1 + 0.7 * v0 * v0 / (g * d)) / 1.7 : 2. / 3 + v0 * v0 / (3 * g * d);
        CHECK(cosine == Approx(rolling ? 0.5895268 : 0.66771217).epsilon(1e-7));
        std::vector<double> error, of_flight;
        for (const double h : {4e-3, 2e-3, 1e-3}) {
            const Ball b(r, 1, ball_of_radius(R), Vec3(0, 0, d), Vec3(v0, 0, 0), {.enabled = true},
                         rolling ? EvolvingContact::Friction::rolling : EvolvingContact::Friction::none,
                         rolling ? Vec3(0, v0 / r, 0) : Vec3::Zero());
            const BounceRun out = bounce(b, "rA-half-1-momentum", 2.4, h);
            REQUIRE(out.events.size() == 1);
            REQUIRE(out.node.back().body[0].r.z() < 0);
            CHECK(out.events[0].type == ContactEvent::Type::lift_off);
            const double t = out.events[0].t;
            const State& x = out.node[static_cast<size_t>(t / h)];
            const double dt = t - x.t;
            const double z = x.body[0].r.z() + dt * x.body[0].rdot.z() + 0.5 * dt * dt * x.body[0].rddot.z();
            error.push_back(std::abs(z / d - cosine));

            // ballistic flight from the exact lift-off, at the height of the centre of the sphere
            const double v = std::sqrt(g * d * cosine), sine = std::sqrt(1 - cosine * cosine);
            const double fall = (-v * sine + std::sqrt(v * v * sine * sine + 2 * g * d * cosine)) / g;
            const double x_exact = d * sine + v * cosine * fall;
            for (size_t n = 1; n < out.node.size(); ++n) {
                const Vec3 a = out.node[n - 1].body[0].r, c = out.node[n].body[0].r;
                if (a.z() > 0 && c.z() <= 0) {
                    const Vec3 w = out.node[n - 1].body[0].rdot;
                    const double s = (w.z() + std::sqrt(w.z() * w.z() + 2 * g * a.z())) / g;
                    of_flight.push_back(std::abs(a.x() + s * w.x() - x_exact));
                }
            }
            for (const State& s : out.node) CHECK(s.body[0].r.norm() > d - 1e-13);
        }
        INFO("rolling " << rolling << ", errors of the cosine " << error[0] << ' ' << error[1] << ' '
                        << error[2] << ", of the flight " << of_flight[0] << ' ' << of_flight[1] << ' '
                        << of_flight[2]);
        CHECK(error[0] < (rolling ? 1.2e-5 : 1.5e-5));
        CHECK(std::log2(error[0] / error[2]) / 2 > 1.7);
        if (!rolling) CHECK(std::log2(of_flight[0] / of_flight[2]) / 2 > 1.7);
    }
}

TEST_CASE("a ball with e = 1 in a bowl conserves energy over its impacts (long)", "[contact][unilateral]")
{
    const Shape bowl{std::make_shared<contact::Ellipsoid>(Vec3(4, 3, 2), true)};
    const Ball b(0.5, 1, bowl, Vec3(0.4, 0.9, 0.3), Vec3(0.2, -0.1, 0), {true, 1});
    const double before = lie::energy(b.model, b.x);
    const BounceRun r = bounce(b, "rA-half-1-momentum", 5, 5e-3);
    CHECK(r.events.size() > 3);
    for (const ContactEvent& e : r.events) CHECK(e.type == ContactEvent::Type::impact);
    CHECK(lie::energy(b.model, r.node.back()) == Approx(before).margin(1e-10));
}

TEST_CASE("a ball whose rebounds have ended stays in contact and keeps its tangential velocity",
          "[contact][unilateral]")
{
    const double R = 0.1;
    for (const double e : {0., 0.5}) {
        const Ball b(R, 1, plane, Vec3(0, 0, R + 0.2), Vec3(0.3, 0, 0), {true, e});
        const BounceRun r = bounce(b, "rA-half-1-momentum", 2, 4e-3);
        CHECK(r.events.back().type == ContactEvent::Type::closing);
        CHECK((e > 0) == (r.events.size() > 1));
        const State& x = r.node.back();
        CHECK(x.discrete_state[0] == 0);
        CHECK(x.body[0].r.z() == Approx(R).epsilon(1e-14));
        CHECK(x.body[0].rdot.z() == Approx(0).margin(1e-12));
        CHECK(x.body[0].r.x() == Approx(0.6).epsilon(1e-13));
        const auto& c = static_cast<const EvolvingContact&>(*b.model.general_constraints()[0]);
        CHECK(c.multipliers(b.model.arguments(c, x), x.lambda).F_N == Approx(g).epsilon(1e-9));
    }
}

TEST_CASE("a ball falls into a groove and rests on both walls", "[contact][unilateral]")
{
    const double lean = 50 * M_PI / 180, R = 0.2;
    dae::Model model;
    model.add({"ball", 1, 0.4 * R * R * Mat3::Identity()});
    for (const double side : {-1., 1.}) {
        // wall normals at this angle from the vertical, towards the middle
        const Mat3 A = lie::exp(Vec3(0, -side * lean, 0));
        model.constrain(side < 0 ? "left" : "right",
                        std::make_unique<EvolvingContact>(
                            0, ball_of_radius(R), dae::ground, Shape{plane.surface, Vec3::Zero(), A},
                            EvolvingContact::Friction::none, EvolvingContact::NormalRows::tangent,
                            Unilateral{.enabled = true, .restitution = 0.3}));
    }
    State x;
    x.body.resize(1);
    x.body[0].r = Vec3(0.05, 0, R / std::cos(lean) + 0.3);
    dae::start(model, x);
    CHECK(x.discrete_state == std::vector<int>{1, 1});
    contact::UnilateralStep step(model, lie::scheme("rA-half-1-momentum"), {.tolerance = 1e-13});
    const State end = lie::march(x, step, lie::TimeGrid::over(4, 5e-3)).row.back();
    CHECK(end.discrete_state == std::vector<int>{0, 0});
    CHECK(end.body[0].r.z() == Approx(R / std::cos(lean)).epsilon(1e-12));
    CHECK(end.body[0].r.x() == Approx(0).margin(1e-12));
    for (const auto& constraint : model.general_constraints()) {
        const auto& c = static_cast<const EvolvingContact&>(*constraint);
        CHECK(c.multipliers(model.arguments(c, end), end.lambda).F_N ==
              Approx(7.630825370750323).epsilon(1e-9));
    }
}

TEST_CASE("a ball that falls on a ball on the ground rebounds from both", "[contact][unilateral]")
{
    dae::Model model;
    const double R = 0.1, e = 0.5, drop = 0.4;
    model.add({"lower", 1, 0.4 * R * R * Mat3::Identity()});
    model.add({"upper", 2, 0.8 * R * R * Mat3::Identity()});
    const auto add = [&](const char* name, int i, int j, const Shape& shape_j) {
        model.constrain(
            name, std::make_unique<EvolvingContact>(
                      i, ball_of_radius(R), j, shape_j, EvolvingContact::Friction::none,
                      EvolvingContact::NormalRows::tangent, Unilateral{.enabled = true, .restitution = e}));
    };
    add("on the ground", 0, dae::ground, plane);
    add("on the ball", 1, 0, ball_of_radius(R));
    State x;
    x.body.resize(2);
    x.body[0].r = Vec3(0, 0, R);
    x.body[1].r = Vec3(0, 0, 3 * R + drop);
    dae::start(model, x);
    CHECK(x.discrete_state == std::vector<int>{0, 1});
    contact::UnilateralStep step(model, lie::scheme("rA-half-1-momentum"), {.tolerance = 1e-13});
    std::vector<State> node = lie::march(x, step, lie::TimeGrid::over(0.5, 3e-3)).row;
    // the lower ball cannot move, so the upper one rebounds as from the ground
    REQUIRE(!step.events().empty());
    CHECK(step.events()[0].t == Approx(std::sqrt(2 * drop / g)).epsilon(1e-11));
    double highest = 0;
    for (const State& s : node)
        if (s.t > step.events()[0].t) highest = std::max(highest, s.body[1].r.z());
    CHECK(highest == Approx(3 * R + e * e * drop).epsilon(1e-4));
    CHECK(node.back().body[0].r.z() == Approx(R).epsilon(1e-13));
}

TEST_CASE("two free bodies conserve momentum in an impact", "[contact][unilateral]")
{
    dae::Model model;
    model.gravity.setZero();
    model.add({"i", 1, Vec3(0.010, 0.012, 0.015).asDiagonal()});
    model.add({"j", 3, Vec3(0.05, 0.06, 0.04).asDiagonal()});
    const Shape egg{std::make_shared<contact::Ellipsoid>(Vec3(0.3, 0.2, 0.15))},
        other{std::make_shared<contact::Ellipsoid>(Vec3(0.2, 0.25, 0.3))};
    model.constrain("contact",
                    std::make_unique<EvolvingContact>(0, egg, 1, other, EvolvingContact::Friction::none,
                                                      EvolvingContact::NormalRows::tangent,
                                                      Unilateral{.enabled = true, .restitution = 0.7}));
    State x;
    x.body.resize(2);
    x.body[0].r = Vec3(-0.5, 0.05, 0.02), x.body[0].rdot = Vec3(1, 0, 0);
    x.body[0].omega_bar = Vec3(0.4, 1.1, -0.6);
    x.body[1].r = Vec3(0.4, 0, 0), x.body[1].omega_bar = Vec3(-0.3, 0.2, 0.5);
    dae::start(model, x);
    const auto momenta = [&](const State& s) {
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (int b = 0; b < 2; ++b) {
            const lie::Motion& body = s.body[b];
            const Vec3 p = model.mass().m[b] * body.rdot;
            sum.head<3>() += p;
            sum.tail<3>() += body.r.cross(p) + body.A * (model.mass().J_bar[b] * body.omega_bar);
        }
        return sum;
    };
    contact::UnilateralStep step(model, lie::scheme("rA-half-1-momentum"), {.tolerance = 1e-14});
    const std::vector<State> node = lie::march(x, step, lie::TimeGrid::over(1, 2e-3)).row;
    REQUIRE(step.events().size() >= 1);
    CHECK((momenta(node.back()).head<3>() - momenta(x).head<3>()).norm() < 1e-13);
    CHECK((momenta(node.back()).tail<3>() - momenta(x).tail<3>()).norm() < 1e-4);
    CHECK(lie::energy(model, node.back()) < lie::energy(model, x));
}

TEST_CASE("a run through impacts resumes from any node bit for bit", "[contact][unilateral]")
{
    for (const char* scheme : {"rA-half-1-momentum", "rA-half-1", "rA-rattle", "rA-genalpha"}) {
        INFO(scheme);
        const Ball b(0.1, 1, plane, Vec3(0, 0, 0.3), Vec3(0.1, 0, 0), {true, 0.6});
        const lie::Settings settings{.tolerance = 1e-13};
        contact::UnilateralStep whole(b.model, lie::scheme(scheme), settings);
        State x = b.x, resumed;
        for (int n = 0; n < 150; ++n) {
            contact::UnilateralStep fresh(b.model, lie::scheme(scheme), settings);
            fresh.restore(whole.history());
            resumed = x;
            const State before = x;
            whole.step(x, 5e-3);
            b.model.accepted(before, x);
            fresh.step(resumed, 5e-3);
            b.model.accepted(before, resumed);
            REQUIRE(x.body[0].r == resumed.body[0].r);
            REQUIRE(x.body[0].rdot == resumed.body[0].rdot);
            REQUIRE(x.discrete_state == resumed.discrete_state);
            REQUIRE(whole.events() == fresh.events());
        }
        CHECK(whole.events().size() > 2);
        CHECK_THROWS_WITH(whole.restore({}), Catch::Contains("as many unilateral contacts, got 0"));
    }
}

TEST_CASE("contacts with indeterminate forces are named, or switch to their fallback",
          "[contact][unilateral]")
{
    // four walls of a pyramid hold a ball; three of them are sufficient
    const double R = 0.2, lean = 0.6;
    for (const bool fallback : {false, true}) {
        dae::Model model;
        model.add({"ball", 1, 0.4 * R * R * Mat3::Identity()});
        for (int k = 0; k < 4; ++k) {
            const Mat3 A = lie::exp(Vec3(0, 0, k * M_PI / 2)) * lie::exp(Vec3(0, lean, 0));
            const std::string name = "wall " + std::to_string(k);
            auto c = std::make_unique<EvolvingContact>(0, ball_of_radius(R), dae::ground,
                                                       Shape{plane.surface, Vec3::Zero(), A});
            if (fallback) {
                auto force = std::make_unique<contact::ContactForce>(
                    name, model, 0, ball_of_radius(R), dae::ground, c->shape_j,
                    std::make_shared<contact::Hooke>(contact::Hooke::with_restitution(1e5, 0.2)),
                    contact::frictionless());
                c->fallback = true;
                force->set_fallback_of(*c);
                model.load(std::move(force));
            }
            model.constrain(name, std::move(c));
        }
        State x;
        x.body.resize(1);
        x.body[0].r = Vec3(0, 0, R / std::cos(lean));
        if (!fallback) {
            CHECK_THROWS_WITH(dae::start(model, x),
                              Catch::Contains("already prevent the same motion: contact 'wall 3'"));
            continue;
        }
        CHECK(dae::start(model, x).rank == 3);
        CHECK(dae::Model::mode(*model.general_constraints()[3], x) == EvolvingContact::fallback_active);
        const auto step = contact::make_integrator(model, lie::scheme("rA-half-1-momentum"), {});
        const State end = lie::march(x, *step, lie::TimeGrid::over(1, 1e-3)).row.back();
        CHECK((end.body[0].r - x.body[0].r).norm() < 1e-9);
    }
}

TEST_CASE("a contact whose curvature vanishes during a run switches to its fallback", "[contact][unilateral]")
{
    // the superquadric of exponent 4 has zero curvature on its axes; it rolls there from the side
    const Shape block{std::make_shared<contact::Superquadric>(Vec3(0.3, 0.3, 0.2), 4)};
    for (const bool fallback : {false, true}) {
        dae::Model model;
        model.add({"block", 1, Vec3(0.02, 0.02, 0.03).asDiagonal()});
        auto c = std::make_unique<EvolvingContact>(0, block, dae::ground, plane);
        if (fallback) {
            auto force = std::make_unique<contact::ContactForce>(
                "floor", model, 0, block, dae::ground, plane,
                std::make_shared<contact::Hooke>(contact::Hooke::with_restitution(1e5, 0.2)),
                contact::frictionless());
            c->fallback = true;
            force->set_fallback_of(*c);
            model.load(std::move(force));
        }
        model.constrain("floor", std::move(c));
        State x;
        x.body.resize(1);
        x.body[0].A = lie::exp(Vec3(0.4, 0.3, 0));
        x.body[0].r = Vec3(0, 0, 0.3);
        dae::start(model, x, {.fix_initial = true});
        const auto step = contact::make_integrator(model, lie::scheme("rA-half-1-momentum"), {});
        const lie::TimeGrid grid = lie::TimeGrid::over(1, 1e-3);
        if (!fallback) {
            CHECK_THROWS_AS(lie::march(x, *step, grid), lie::NumericalFailure);
            continue;
        }
        const State end = lie::march(x, *step, grid).row.back();
        CHECK(dae::Model::mode(*model.general_constraints()[0], end) == EvolvingContact::fallback_active);
        CHECK(end.body[0].r.z() > 0.19);
    }
}

TEST_CASE("an impact at a node is resolved like any other impact", "[contact][unilateral]")
{
    // 0.5 g t² = 0.2 m at t = 0.2 s, the 20th node
    const double R = 0.1, up = 9.8;
    for (const char* scheme : {"rA-half-1-momentum", "rA-rattle"}) {
        INFO(scheme);
        dae::Model model;
        model.gravity = Vec3(0, 0, -up);
        model.add({"ball", 1, 0.004 * Mat3::Identity()});
        model.constrain("floor", std::make_unique<EvolvingContact>(
                                     0, ball_of_radius(R), dae::ground, plane,
                                     EvolvingContact::Friction::none, EvolvingContact::NormalRows::tangent,
                                     Unilateral{.enabled = true, .restitution = 1}));
        State x;
        x.body.resize(1);
        x.body[0].r = Vec3(0, 0, R + 0.5 * up * 0.2 * 0.2);
        dae::start(model, x);
        const double before = lie::energy(model, x);
        contact::UnilateralStep step(model, lie::scheme(scheme), {.tolerance = 1e-13});
        const State end = lie::march(x, step, lie::TimeGrid::over(4, 1e-2)).row.back();
        CHECK(step.events().size() == 10);
        for (const ContactEvent& e : step.events()) CHECK(e.type == ContactEvent::Type::impact);
        CHECK(lie::energy(model, end) == Approx(before).epsilon(1e-10));
    }
}

TEST_CASE("a unilateral contact has the forces of a bilateral one while it is active",
          "[contact][unilateral]")
{
    const Shape bowl{std::make_shared<contact::Ellipsoid>(Vec3(4, 3, 2), true)};
    const Vec3 from(0, 1.3203946979732251, -1.2654225449401855);
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::algebraic)) continue;
        INFO(s.name);
        std::vector<State> of[2];
        for (const bool opens : {false, true}) {
            const Ball b(0.5, 1, bowl, from, Vec3::Zero(), {.enabled = opens});
            const auto step = contact::make_integrator(b.model, s, {.tolerance = 1e-13});
            of[opens] = lie::march(b.x, *step, lie::TimeGrid::over(0.1, 5e-3)).row;
        }
        for (size_t n = 0; n < of[0].size(); ++n) {
            CHECK((of[0][n].lambda - of[1][n].lambda).norm() < 1e-9 * of[0][n].lambda.norm());
            CHECK((of[0][n].body[0].rddot - of[1][n].body[0].rddot).norm() < 1e-9);
        }
    }
}

TEST_CASE("a contact that separates or approaches at the start starts inactive", "[contact][unilateral]")
{
    const double R = 0.1;
    for (const double v : {2., -2.}) {
        const Ball b(R, 1, plane, Vec3(0, 0, R), Vec3(0, 0, v), {true, 1});
        CHECK(b.x.discrete_state[0] == EvolvingContact::inactive);
        const BounceRun r = bounce(b, "rA-half-1-momentum", 0.1, 1e-3);
        CHECK(r.node.back().body[0].r.z() == Approx(R + 0.2 - 0.5 * g * 0.01).epsilon(1e-10));
        CHECK(r.events.size() == (v < 0 ? 1 : 0));
    }
}

TEST_CASE("a step with unilateral contacts that fails does not change the state", "[contact][unilateral]")
{
    // one iteration cannot reach the tolerance, so the step fails
    const Shape bowl{std::make_shared<contact::Ellipsoid>(Vec3(4, 3, 2), true)};
    dae::Model model;
    model.add({"ball", 1, 0.1 * Mat3::Identity()});
    auto c = std::make_unique<EvolvingContact>(
        0, ball_of_radius(0.5), dae::ground, bowl, EvolvingContact::Friction::none,
        EvolvingContact::NormalRows::tangent, Unilateral{.enabled = true});
    model.constrain("contact", std::move(c));
    State x;
    x.body.resize(1);
    x.body[0].r = Vec3(0, 1.3203946979732251, -1.2654225449401855);
    dae::start(model, x);
    contact::UnilateralStep step(model, lie::scheme("rA-half-1-momentum"),
                                 {.tolerance = 1e-300, .max_iterations = 1});
    const State before = x;
    CHECK_THROWS_AS(step.step(x, 1e-2), lie::NumericalFailure);
    CHECK(x.body[0].r == before.body[0].r);
    CHECK(x.lambda == before.lambda);
    CHECK(x.alpha == before.alpha);
    CHECK(x.discrete_state == before.discrete_state);
    CHECK(x.internal_state == before.internal_state);
    CHECK(step.events().empty());
}
