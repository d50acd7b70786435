// SPDX-License-Identifier: GPL-3.0-or-later
/// Scenes of free bodies: an impact, the same by body types, and what is refused.

#include "contact/scenes/scene.hpp"

#include "contact/normal/normal_law.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/check.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>

using namespace hilda;
using namespace hilda::contact;

namespace {

constexpr double R = 0.1, k = 1e5;

Inertia ball(double m) { return {.m = m, .J_bar = Mat3(0.4 * m * R * R * Mat3::Identity())}; }
Shape sphere() { return {.surface = std::make_shared<Sphere>(R)}; }
Motion at(const Vec3& r, const Vec3& v = Vec3::Zero())
{
    Motion motion;
    motion.r = r, motion.rdot = v;
    return motion;
}

std::string refusal(const std::function<void()>& f)
{
    try {
        f();
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
    return "nothing is refused";
}

}  // namespace

TEST_CASE("two bodies of a scene exchange their momentum as the closed form of an impact requires",
          "[contact][scene]")
{
    const double m_i = 2, m_j = 3, v = 0.5, m = m_i * m_j / (m_i + m_j), h = 1e-6;
    const bool by_types = GENERATE(false, true);
    const auto law = std::make_shared<Hooke>(k, 0);
    const Motion left = at({-0.10001, 0, 0}, {v, 0, 0}), right = at({0.10001, 0, 0});
    Scene scene;
    scene.gravity = {0, 0, -9.81};
    if (by_types) {
        const int light = scene.add({.inertia = ball(m_i), .shape = sphere(), .reach = R}),
                  heavy = scene.add({.inertia = ball(m_j), .shape = sphere(), .reach = R});
        scene.set_contact_law("impact", light, heavy, law, frictionless());
        scene.add_body(light, left), scene.add_body(heavy, right);
    } else {
        scene.add(ball(m_i), left), scene.add(ball(m_j), right);
        scene.add("impact", 0, sphere(), 1, sphere(), law, frictionless());
    }
    scene.check(h);
    const double duration = std::numbers::pi * std::sqrt(m / k);
    double nearest = 1;
    const int steps = static_cast<int>(1.2 * duration / h) + 40;
    for (int n = 0; n < steps; ++n) {
        scene.step(h);
        nearest = std::min(nearest, scene.body[1].r.x() - scene.body[0].r.x());
    }
    INFO((by_types ? "by types" : "a pair"));
    CHECK(2 * R - nearest == Approx(v * std::sqrt(m / k)).epsilon(1e-3));
    CHECK(scene.body[0].rdot.x() == Approx(v * (m_i - m_j) / (m_i + m_j)).epsilon(1e-4));
    CHECK(scene.body[1].rdot.x() == Approx(v * 2 * m_i / (m_i + m_j)).epsilon(1e-4));
    CHECK(scene.body[0].rdot.z() == Approx(-9.81 * scene.t));
    CHECK(scene.t == Approx(steps * h));
}

TEST_CASE("a scene refuses wrong bodies, pairs, starts and steps", "[contact][scene]")
{
    const auto law = std::make_shared<Hooke>(k, 0);
    Scene scene;
    scene.add(ball(2), at({0, 0, R}));
    scene.add(Inertia{}, {});
    const auto pair = [&](int i, int j) {
        return refusal([&] { scene.add("p", i, sphere(), j, sphere(), law, frictionless()); });
    };
    CHECK(refusal([&] { scene.add(ball(-2), {}); }) ==
          "contact::Scene: the mass of a body must be positive, got -2");
    CHECK(refusal([&] { scene.add(ball(0), {}); }) ==
          "contact::Scene: the mass of a body must be positive, got 0");
    CHECK(pair(0, 2) == "contact::Scene: no body has this index, got 2");
    CHECK(pair(-1, 0) == "contact::Scene: no body has this index, got -1");
    CHECK(pair(1, 1) == "contact::Scene: a contact needs two different bodies, got 1");
    CHECK(scene.pair.empty());

    scene.add("floor", 0, sphere(), 1, {.surface = std::make_shared<Plane>()}, law, frictionless());
    const double bound = 2 / std::sqrt(k / 2);
    CHECK_NOTHROW(scene.check(0.99 * bound));
    CHECK_THAT(
        refusal([&] { scene.check(1.01 * bound); }),
        Catch::StartsWith(
            "contact 'floor': the step must not exceed its stability bound of 0.00894427 s, got 0.0090"));
    scene.body[0].r.setZero();
    CHECK(refusal([&] { scene.check(1e-6); }) ==
          "contact 'floor': the surfaces must not overlap by more than 0.01 m, a tenth of the radius of "
          "curvature "
          "0.1 m, got 0.1 m");
}
