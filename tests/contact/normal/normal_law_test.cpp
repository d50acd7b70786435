// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/normal/normal_law.hpp"

#include "contact/scenes/scene.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "lie/check.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using contact::Shape;
using lie::Mat3;
using lie::Vec3;

namespace {

/// Coefficient of restitution measured with a ball of 2 kg that hits a plane at the speed v with step h
double rebound(const std::shared_ptr<const contact::NormalLaw>& law, double v, double h)
{
    contact::Scene scene;
    scene.gravity.setZero();
    lie::Motion m;
    m.r = {0, 0, 0.1 + 1e-4};
    m.rdot = {0, 0, -v};
    scene.add({2, 0.4 * 2 * 0.01 * Mat3::Identity()}, m);
    scene.add(contact::Inertia{}, {});
    scene.add("ball-plane", 0, Shape{std::make_shared<contact::Sphere>(0.1)}, 1,
              Shape{std::make_shared<contact::Plane>()}, law,
              contact::friction_law("slide-roll-spin").make({.K_E = 1}));
    do scene.step(h);
    while (scene.body[0].rdot.z() < 0 || scene.pair[0].contact_state.N > 0);
    return scene.body[0].rdot.z() / v;
}

}  // namespace

TEST_CASE("normal laws reproduce the given coefficient of restitution (long)", "[contact][normal]")
{
    using namespace contact;
    const double e = GENERATE(1., 0.8, 0.5, 0.1);  // for the last value the damping is overcritical
    INFO("e " << e);
    CHECK(rebound(std::make_shared<Hooke>(Hooke::with_restitution(1e6, e)), 0.5, 1e-6) ==
          Approx(e).margin(2e-3));
    for (const double v : {0.1, 1.})
        CHECK(rebound(std::make_shared<Hertz>(1e9, e), v, 1e-7) == Approx(e).margin(2e-3));
}

TEST_CASE("the damping ratio of a free oscillation gives too fast a rebound", "[contact][normal]")
{
    using contact::Hertz;
    const auto codes = std::make_shared<Hertz>(Hertz::of_free_oscillation(1e9, 0.5));
    CHECK(rebound(codes, 0.5, 1e-7) == Approx(0.550).margin(2e-3));
}

TEST_CASE("damping_ratio inverts the closed form of the restitution", "[contact][normal]")
{
    for (const double zeta : {0.05, 0.5, 0.999, 1.0, 1.001, 3.0}) {
        const double x = 1 - zeta * zeta;
        const double loss =
            x == 0 ? 2
                   : 2 * zeta * (x > 0 ? std::acos(zeta) / std::sqrt(x) : std::acosh(zeta) / std::sqrt(-x));
        CHECK(contact::damping_ratio(std::exp(-loss)) == Approx(zeta).epsilon(1e-6));
    }
    CHECK(contact::damping_ratio(1) == 0);
}

TEST_CASE("an elastic Hertzian impact has the closed-form maximum overlap", "[contact][normal]")
{
    // Maximum overlap of an elastic impact: (15 m v² / (16 E* √R))^(2/5)
    const double E = 1e8, R = 0.1, m = 2, v = 1;
    const double deepest = std::pow(15 * m * v * v / (16 * E * std::sqrt(R)), 0.4);
    const contact::Hertz law(E);
    const contact::NormalInput p{.overlap = deepest, .overlap_rate = 0, .curvature = 1 / R, .m = m};
    CHECK(0.4 * law.force(p) * deepest == Approx(0.5 * m * v * v));  // the elastic energy is 2/5 F δ
    CHECK(law.stiffness(p) == Approx(1.5 * law.force(p) / deepest));
}

TEST_CASE("the effective modulus of two equal materials is half the plane-strain modulus",
          "[contact][normal]")
{
    CHECK(contact::effective_modulus(2e11, 0.3, 2e11, 0.3) == Approx(2e11 / (2 * 0.91)));
}

TEST_CASE("normal laws reject invalid parameters", "[contact][normal]")
{
    using namespace contact;
    const auto refusal = [](auto make) -> std::string {
        try {
            make();
        } catch (const lie::InvalidInput& e) {
            return e.what();
        }
        return "";
    };
    CHECK(refusal([] { GivenForce(-1); }) ==
          "contact::GivenForce: a given normal force must not be negative, got -1");
    CHECK(refusal([] { Hooke(0, 0); }) == "contact::Hooke: the normal stiffness must be positive, got 0");
    CHECK(refusal([] { Hooke(1, -2); }) == "contact::Hooke: the normal damping must not be negative, got -2");
    CHECK(refusal([] { Hooke::with_restitution(1, 1.5); }) ==
          "contact::damping_ratio: the coefficient of restitution must be in [0, 1], got 1.5");
    CHECK(refusal([] { Hertz(1e9, -0.5); }) ==
          "contact::damping_ratio: the coefficient of restitution must be in [0, 1], got -0.5");
    CHECK(refusal([] { Hertz(-1e9); }) ==
          "contact::Hertz: the effective modulus must be positive, got -1e+09");
    CHECK(refusal([] { effective_modulus(2e11, 0.6, 2e11, 0.3); }) ==
          "contact::effective_modulus: Poisson's ratio must be in (-1, 0.5], got 0.6");
    CHECK(refusal([] { effective_modulus(std::nan(""), 0.3, 2e11, 0.3); }) ==
          "contact::effective_modulus: Young's modulus must be positive, got nan");
}
