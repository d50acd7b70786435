// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs with several contact points: a run ends where another point than the one that it follows overlaps.
#include "contact/detection/other_points.hpp"
#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/unilateral.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/torus.hpp"
#include "dae/start.hpp"
#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::contact;
using lie::State;

namespace {

enum class Kind { hertz, unilateral };

/// A ball and one contact with a surface on the ground
struct Ball {
    dae::Model model;
    State x;

    Ball(Kind kind, double R, const std::shared_ptr<const Surface>& on, const Vec3& r, const Vec3& v)
    {
        constexpr double m = 1;
        const Shape ball{.surface = std::make_shared<Sphere>(R)}, ground{.surface = on};
        model.add({.name = "ball", .m = m, .J_bar = 0.4 * m * R * R * Mat3::Identity()});
        if (kind == Kind::unilateral)
            model.constrain("c", std::make_unique<EvolvingContact>(
                                     0, ball, dae::ground, ground, EvolvingContact::Friction::none,
                                     EvolvingContact::NormalRows::tangent, Unilateral{.enabled = true}));
        else
            model.load(std::make_unique<ContactForce>("c", model, 0, ball, dae::ground, ground,
                                                      std::make_shared<Hertz>(1e6), frictionless()));
        x.body.resize(1);
        x.body[0].r = r;
        x.body[0].rdot = v;
        dae::start(model, x);
    }
    double energy(const State& s) const
    {
        return 0.5 * s.body[0].rdot.squaredNorm() + model.potential_energy(s);
    }
};

struct Outcome {
    std::string status = "ok", message = {};
    State end = {};
    double most_energy = 0, largest_overlap = 0;
};

Outcome run(const Ball& ball, double t, double h, const std::function<double(const Vec3&)>& distance,
            double R)
{
    Outcome out;
    struct NodeObserver final : lie::Observer {
        std::function<void(const State&)> on_node;
        void accepted(const State& node, long, int) override { on_node(node); }
    } observer;
    observer.on_node = [&](const State& s) {
        out.end = s;
        out.most_energy = std::max(out.most_energy, ball.energy(s));
        out.largest_overlap = std::max(out.largest_overlap, R - distance(s.body[0].r));
    };
    const auto integrator = make_integrator(ball.model, lie::scheme("rA-half-1-momentum"), {});
    lie::Observer* all[] = {&observer};
    lie::March march(ball.x, *integrator, h);
    try {
        while (static_cast<double>(march.number()) * h < t) march.advance(all);
    } catch (const lie::NumericalFailure& e) {
        out.status = e.status, out.message = e.what();
    }
    return out;
}

/// Distance of a point from an ellipsoid of semi-axes 1, 1, 0.4 from inside, by a search over its meridian
double distance_from_bowl(const Vec3& c)
{
    const double rho = c.head<2>().norm();
    double least = 10;
    for (int k = -4000; k <= 4000; ++k) {
        const double angle = k * M_PI / 4000;
        least = std::min(least, std::hypot(std::cos(angle) - rho, 0.4 * std::sin(angle) - c.z()));
    }
    return least;
}

}  // namespace

TEST_CASE("pairs that may have several contact points are known", "[contact][detection]")
{
    const auto shape = [](auto surface) {
        return Shape{.surface = std::make_shared<decltype(surface)>(surface)};
    };
    const Shape ball = shape(Sphere(0.3)), egg = shape(Ellipsoid(Vec3(0.3, 0.2, 0.1))),
                floor = shape(Plane()), round_bowl = shape(Sphere(1, true)),
                bowl = shape(Ellipsoid(Vec3(1, 1, 0.4), true)), ring = shape(Torus(0.4, 0.1));
    for (const auto& [i, j] :
         {std::pair{ball, ball}, {ball, floor}, {egg, ball}, {ball, round_bowl}, {ring, floor}})
        CHECK_FALSE(OtherPoints::possible(i, j));
    for (const auto& [i, j] :
         {std::pair{ball, bowl}, {bowl, ball}, {egg, round_bowl}, {ball, ring}, {ring, ring}})
        CHECK(OtherPoints::possible(i, j));
}

TEST_CASE("a ball too large for the rim of its bowl ends the run where it touches the second point (long)",
          "[contact][detection]")
{
    const Kind kind = GENERATE(Kind::hertz, Kind::unilateral);
    const Ball ball(kind, 0.3, std::make_shared<Ellipsoid>(Vec3(1, 1, 0.4), true), {0, 0, -0.1 + 1e-6},
                    {3, 0, 0});
    const Outcome out = run(ball, 2, 1e-4, distance_from_bowl, 0.3);
    INFO(out.message);
    CHECK(out.status == "contact_not_unique");
    CHECK(out.message.find("contact 'c'") != std::string::npos);
    CHECK(out.largest_overlap < 0.02);
    CHECK(out.most_energy < ball.energy(ball.x) * (1 + 1e-3) + 1e-3);
}

TEST_CASE("a ball dropped on a ring that is too narrow does not fall through it (long)",
          "[contact][detection]")
{
    constexpr double R = 0.35;
    const double x0 = GENERATE(0., 0.02, 0.1);
    const Kind kind = GENERATE(Kind::unilateral, Kind::hertz);
    const Ball ball(kind, R, std::make_shared<Torus>(0.4, 0.1), {x0, 0.003, 0.6}, Vec3::Zero());
    const Outcome out = run(
        ball, 1, 1e-3, [](const Vec3& c) { return std::hypot(c.head<2>().norm() - 0.4, c.z()) - 0.1; }, R);
    INFO(out.status << ' ' << out.message << ' ' << out.end.body[0].r.transpose());
    CHECK(out.largest_overlap < (kind == Kind::hertz ? 0.05 : 0.02) * R);
    CHECK(out.end.body[0].r.z() > 0.2);
    if (kind == Kind::hertz) CHECK(out.status == "ok");
    // the contact is a circle where the ball touches the ring all around
    else
        CHECK(out.status == "contact_singular");
}
