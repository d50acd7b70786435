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

/// Speed at which a ball of 2 kg leaves a plane, over that at which it came
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

TEST_CASE("normal laws give the coefficient of restitution they are told (long)", "[contact][normal]")
{
    using namespace contact;
    const double e = GENERATE(1., 0.8, 0.5, 0.1);  // of the last the dashpot is beyond critical
    INFO("e " << e);
    CHECK(rebound(std::make_shared<Hooke>(Hooke::rebounding(1e6, e)), 0.5, 1e-6) == Approx(e).margin(2e-3));
    for (const double v : {0.1, 1.})
        CHECK(rebound(std::make_shared<Hertz>(1e9, e), v, 1e-7) == Approx(e).margin(2e-3));
}

TEST_CASE("the damping ratio of contact codes lets bodies part too fast", "[contact][normal]")
{
    using contact::Hertz;
    const auto codes = std::make_shared<Hertz>(Hertz::of_free_oscillation(1e9, 0.5));
    CHECK(rebound(codes, 0.5, 1e-7) == Approx(0.550).margin(2e-3));
}

TEST_CASE("the damping ratio is that of the closed form", "[contact][normal]")
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

TEST_CASE("a Hertzian ball is pressed in by the textbook depth", "[contact][normal]")
{
    // Maximum overlap of an elastic impact: (15 m v² / (16 E* √R))^(2/5)
    const double E = 1e8, R = 0.1, m = 2, v = 1;
    const double deepest = std::pow(15 * m * v * v / (16 * E * std::sqrt(R)), 0.4);
    const contact::Hertz law(E);
    const contact::NormalInput p{.overlap = deepest, .overlap_rate = 0, .curvature = 1 / R, .m = m};
    CHECK(0.4 * law.force(p) * deepest == Approx(0.5 * m * v * v));  // energy of k δ^(3/2) is 2/5 F δ
    CHECK(law.stiffness(p) == Approx(1.5 * law.force(p) / deepest));
}

TEST_CASE("steel on steel has half the plane-strain modulus of steel", "[contact][normal]")
{
    CHECK(contact::effective_modulus(2e11, 0.3, 2e11, 0.3) == Approx(2e11 / (2 * 0.91)));
}

TEST_CASE("normal laws refuse values that are none", "[contact][normal]")
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
    CHECK(refusal([] { Hooke::rebounding(1, 1.5); }) ==
          "contact::damping_ratio: the coefficient of restitution must be in [0, 1], got 1.5");
    CHECK(refusal([] { Hertz(1e9, -0.5); }) ==
          "contact::damping_ratio: the coefficient of restitution must be in [0, 1], got -0.5");
    CHECK(refusal([] { Hertz(-1e9); }) ==
          "contact::Hertz: the effective modulus must be positive, got -1000000000");
    CHECK(refusal([] { effective_modulus(2e11, 0.6, 2e11, 0.3); }) ==
          "contact::effective_modulus: Poisson's ratio must be in (-1, 0.5], got 0.59999999999999998");
    CHECK(refusal([] { effective_modulus(std::nan(""), 0.3, 2e11, 0.3); }) ==
          "contact::effective_modulus: Young's modulus must be positive, got nan");
}
