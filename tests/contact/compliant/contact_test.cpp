// SPDX-License-Identifier: GPL-3.0-or-later
// CompliantContact: rejected starts, stability limit of the step, bounds of the deflections.
#include "contact/compliant/contact.hpp"

#include "contact/friction/laws/spring.hpp"
#include "contact/scenes/scene.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "lie/check.hpp"
#include "tests/contact/compliant/slide_roll_spin.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using contact::FrictionParameters;
using contact::Inertia;
using contact::Shape;
using lie::Mat3;
using lie::Motion;
using lie::Vec3;
using tests::slide_roll_spin;

namespace {

std::string refusal(const std::function<void()>& make)
{
    try {
        make();
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
    return "";
}

Shape sphere(double R, bool concave = false) { return {std::make_shared<contact::Sphere>(R, concave)}; }
const Shape plane{std::make_shared<contact::Plane>()};

Inertia ball(double m, double R) { return {m, 0.4 * m * R * R * Mat3::Identity()}; }

Motion at(const Vec3& r)
{
    Motion m;
    m.r = r;
    return m;
}

contact::CompliantContact rolling_ball(const FrictionParameters& p, double N = 5 * 9.8)
{
    return {"ball",
            sphere(0.2),
            plane,
            ball(5, 0.2),
            {},
            std::make_shared<contact::GivenForce>(N),
            slide_roll_spin(p)};
}

double bound(const contact::CompliantContact& c)
{
    const Motion up = at({0, 0, 0.2}), ground;
    return c.stable_step(c.evaluate(up, ground, {}), up, ground);
}

/// Largest angular velocity of a ball over the last tenth of 2000 steps of h, after a start with 1e-7 m/s. At
/// this speed the system is linear, so that it decays or grows.
double late_speed(double eta_r, double h)
{
    contact::Scene scene;
    Motion m = at({0, 0, 0.2});
    m.rdot = {1e-7, 0, 0};
    scene.add(ball(5, 0.2), m);
    scene.add(Inertia{}, {});
    scene.add("ball", 0, sphere(0.2), 1, plane, std::make_shared<contact::GivenForce>(5 * 9.81),
              slide_roll_spin({.mu_s = 0.5, .mu_k = 0.5, .K_E = 1e5, .eta_r = eta_r}));
    double late = 0;
    for (int k = 0; k < 2000; ++k) {
        scene.step(h);
        if (k > 1800) late = std::max(late, (scene.body[0].A * scene.body[0].omega_bar).norm());
    }
    return late;
}

}  // namespace

TEST_CASE("the stability limit of a sphere is that of its damped tangential oscillation",
          "[contact][stability]")
{
    // ω² = 3.5 K_E / m, damping ratio √3.5: h < 2 (√4.5 - √3.5) / ω
    const double m = 5, K_E = 1e5;
    const double omega = std::sqrt(3.5 * K_E / m);
    CHECK(bound(rolling_ball({.mu_s = 1, .mu_k = 1, .K_E = K_E})) ==
          Approx(2 * (std::sqrt(4.5) - std::sqrt(3.5)) / omega).epsilon(1e-9));
    // without damping: 2/ω
    CHECK(bound(rolling_ball({.mu_s = 1, .mu_k = 1, .K_E = K_E, .zeta = 0})) ==
          Approx(2 / omega).epsilon(1e-9));
    // without stiffness and damping there is no limit
    CHECK(std::isinf(bound(rolling_ball({.mu_s = 0, .mu_k = 0, .K_E = 1e-300}))));
}

TEST_CASE("a step below the stability limit is stable and a step above it is not", "[contact][stability]")
{
    const double eta_r = GENERATE(0., 0.3);
    const double h = bound(rolling_ball({.mu_s = 0.5, .mu_k = 0.5, .K_E = 1e5, .eta_r = eta_r}));
    INFO("eta_r " << eta_r << ", bound " << h);
    if (eta_r > 0) {
        CHECK(h > 1.3e-3);
        CHECK(h < 1.6e-3);
        CHECK(late_speed(eta_r, 0.98 * h) < 1e-10);
        CHECK(late_speed(eta_r, 1.02 * h) > 1e-6);
    } else {  // the ball continues to roll
        CHECK(late_speed(eta_r, 0.98 * h) < 1e-6);
        CHECK(late_speed(eta_r, 1.02 * h) > 1e-4);
    }
}

TEST_CASE("a scene rejects a step above the stability limit", "[contact][stability]")
{
    contact::Scene scene;
    scene.add(ball(5, 0.2), at({0, 0, 0.2}));
    scene.add(Inertia{}, {});
    scene.add("ball-floor", 0, sphere(0.2), 1, plane, std::make_shared<contact::GivenForce>(49),
              slide_roll_spin({.mu_s = 0.5, .mu_k = 0.5, .K_E = 1e5}));
    scene.check(1.8e-3);
    CHECK(refusal([&] { scene.check(2e-3); }) ==
          "contact 'ball-floor': the step must not exceed its stability bound of 0.00189354 s, got 0.002");
}

TEST_CASE("the stability limit of a light ball under a heavy ball takes both contacts into account",
          "[contact][stability]")
{
    const auto energy_after = [](double part) {
        contact::Scene scene;
        const double R = 0.05;
        const int light = scene.add(ball(0.01, R), at({0, 0, R})),
                  heavy = scene.add(ball(1000, 2 * R), at({0, 0, 4 * R}));
        const int floor = scene.add(Inertia{}, {});
        const auto law = std::make_shared<contact::Hertz>(1e8);
        scene.add("floor", light, sphere(R), floor, plane, law, contact::frictionless());
        scene.add("ball", light, sphere(R), heavy, sphere(2 * R), law, contact::frictionless());
        double h = 1;  // the limit, by bisection of the rejected steps
        for (double lower = 1e-9; h > lower * 1.001;) {
            const double middle = std::sqrt(lower * h);
            (refusal([&] { scene.check(middle); }).empty() ? lower : h) = middle;
        }
        h *= part;
        for (double t = 0; t < 0.02; t += h) scene.step(h);
        return scene.kinetic_energy();
    };
    CHECK(energy_after(0.99) < 1000 * 9.81 * 0.01);  // energy of a fall of 1 cm
    CHECK(energy_after(3) > 1e3);
}

TEST_CASE("the stability limit of bodies not yet in contact is that of the expected impact",
          "[contact][stability]")
{
    const auto bound_at = [](double gap) {
        const contact::CompliantContact c("ball", sphere(0.2), plane, ball(5, 0.2), {},
                                          std::make_shared<contact::Hertz>(1e8), contact::frictionless());
        const Motion up = at({0, 0, 0.2 + gap}), ground;
        return c.stable_step(c.state_at_largest_compression(up, ground, {}, 5 * 9.81), up, ground);
    };
    CHECK(bound_at(1e-6) == Approx(bound_at(-1e-9)).epsilon(1e-2));
    CHECK(bound_at(1) < bound_at(1e-6));
}

TEST_CASE("an invalid initial pose of a contact is rejected", "[contact]")
{
    const auto start_error = [](const Shape& i, const Shape& j, const Vec3& r, const FrictionParameters& p) {
        const contact::CompliantContact c("c", i, j, ball(1, 0.1), {},
                                          std::make_shared<contact::Hooke>(1e5, 0), slide_roll_spin(p));
        return c.start_error(at(r), Motion());
    };
    const FrictionParameters slides{.K_E = 1}, rolls{.K_E = 1, .eta_r = 0.1};
    CHECK(start_error(sphere(0.2), plane, {0, 0, 0.2}, rolls).empty());
    CHECK(start_error(sphere(0.2), plane, {0, 0, 0.1801}, slides).empty());
    CHECK(start_error(sphere(0.2), plane, {0, 0, 0.17}, slides) ==
          "the surfaces must not overlap by more than 0.02 m, a tenth of the radius of curvature 0.2 m, got "
          "0.03 m");
    CHECK(start_error(sphere(0.2), sphere(0.5, true), {0, 0, -0.3}, rolls).empty());
    const Shape flat{
        std::make_shared<contact::Ellipsoid>(Vec3(0.4, 0.4, 0.2))};  // curvature 1.25 1/m at the pole
    CHECK(
        start_error(flat, sphere(0.5, true), {0, 0, -0.3}, slides)
            .starts_with("no contact point of two surfaces: the surfaces do not curve away from each other, "
                         "smallest principal curvature of K_i + K_j -0.75 1/m; "));
    const Shape foot{std::make_shared<contact::Foot>()};
    CHECK(start_error(foot, plane, {0, 0, 0}, slides).empty());
    CHECK(
        start_error(foot, plane, {0, 0, 0}, rolls) ==
        "the normal or friction law needs curvature: the sum of the curvatures must be positive, got 0 1/m");
}

TEST_CASE("the initial overlap is compared with the smallest radius of curvature and the size", "[contact]")
{
    const auto start_error = [](const Shape& i, const Shape& j, const Motion& bi, double eta_r = 0) {
        const contact::CompliantContact c("c", i, j, ball(1, 0.1), {},
                                          std::make_shared<contact::Hooke>(1e5, 0),
                                          slide_roll_spin({.K_E = 1, .eta_r = eta_r}));
        return c.start_error(bi, Motion());
    };
    const std::string deep = "the surfaces must not overlap by more than ";
    const Shape shaft{std::make_shared<contact::Cylinder>(0.3)};
    CHECK(start_error(sphere(0.9), shaft, at({1.171, 0, 0})).empty());
    CHECK(start_error(sphere(0.9), shaft, at({1.16, 0, 0})) ==
          deep + "0.03 m, a tenth of the radius of curvature 0.3 m, got 0.04 m");
    const Shape box{std::make_shared<contact::Superquadric>(Vec3(0.1, 0.1, 0.1), 8)};
    CHECK(start_error(box, plane, at({0, 0, 0.091})).empty());
    CHECK(start_error(box, plane, at({0, 0, -0.05})) ==
          deep + "0.01 m, a tenth of the size 0.1 m, got 0.15 m");
    const Shape coin{std::make_shared<contact::Disk>(0.1)};
    Motion leaning = at({0, 0, -0.01});
    leaning.A = lie::exp({0.05, 0, 0});
    CHECK(start_error(coin, plane, leaning) == deep + "0.01 m, a tenth of the size 0.1 m, got 0.0149979 m");
    // parallel to the plane and above it, where the curvature is zero
    CHECK(start_error(coin, plane, at({0, 0, 1}), 0.1).empty());
    CHECK(start_error(coin, plane, at({0, 0, 0})) ==
          "a disk lies flat on a plane: the contact is the whole rim");
}

TEST_CASE("a failed search at the start is a NumericalFailure", "[contact]")
{
    class Lost final : public contact::Surface {  // G = 0 has no solution
    public:
        double value(const Vec3& a) const override { return a.squaredNorm() + 1; }
        Vec3 gradient(const Vec3& a) const override { return 2 * a; }
        Mat3 hessian(const Vec3&) const override { return 2 * Mat3::Identity(); }
        double size() const override { return 1; }
    };
    const contact::CompliantContact c("c", sphere(0.2), {std::make_shared<Lost>()}, ball(1, 0.1), {},
                                      std::make_shared<contact::Hooke>(1e5, 0), slide_roll_spin({.K_E = 1}));
    try {
        c.start_error(at({1, 0.2, 0}), Motion());
        FAIL("accepted");
    } catch (const lie::NumericalFailure& e) {
        CHECK(e.status == "contact_not_converged");
        CHECK_THAT(e.what(), Catch::StartsWith("contact 'c': no contact point of two surfaces: "));
    }
}

TEST_CASE("a normal force that is not finite ends the run with the name of the contact", "[contact]")
{
    // 2 E* overflows; the damping of a restitution of 1 is 0 times infinity
    const contact::CompliantContact c("c", sphere(0.25), plane, ball(1, 0.1), {},
                                      std::make_shared<contact::Hertz>(1e308, 1),
                                      slide_roll_spin({.K_E = 1}));
    CHECK(c.evaluate(at({0, 0, 0.3}), Motion(), {}).N == 0);
    CHECK_THROWS_MATCHES(
        c.evaluate(at({0, 0, 0.1875}), Motion(), {}), lie::NonFinite,
        Catch::Message("contact 'c': the normal force is not finite at an overlap of 0.0625 m"));
}

TEST_CASE("a friction law rejects invalid parameters", "[contact][friction]")
{
    const auto why = [](const FrictionParameters& p) { return refusal([&] { slide_roll_spin(p); }); };
    CHECK(why({.mu_s = 0.2, .mu_k = 0.3, .K_E = 1}) == "friction: mu_s must not be below mu_k, got 0.2");
    CHECK(why({.mu_s = 0.2, .mu_k = -0.5, .K_E = 1}) == "friction: mu_k must not be negative, got -0.5");
    CHECK(why({.K_E = 0}) == "friction: K_E must be positive, got 0");
    CHECK(why({.K_E = 1, .eta_r = -1}) == "friction: eta_r must not be negative, got -1");
    CHECK(why({.K_E = 1, .eta_psi = -1}) == "friction: eta_psi must not be negative, got -1");
    CHECK(why({.K_E = 1, .eta_psi = 0.1, .E_star = 1e9}) ==
          "friction: eta_psi and E_star exclude each other; E_star, got 1e+09");
    CHECK(refusal([] { contact::friction_law("coulomb"); }) ==
          "contact::friction_law: the name must be one of the registered laws constant-torque, epsd, "
          "slide-roll-spin, got 'coulomb'");
}

TEST_CASE("a micro-deflection sticks up to the static bound and slips at the kinetic bound",
          "[contact][friction]")
{
    double H = 0;
    contact::Regime regime;
    const auto grow = [&](double by) {
        H += by;
        contact::return_to_bound(H, regime, 1.25, 1.0);
    };
    grow(-1.2);  // sticks above the kinetic bound
    CHECK((H == -1.2 && !regime.slipping && regime.damped));
    grow(-0.2);  // slips: scaled to the static bound in this step, with its sign
    CHECK((H == -1.25 && regime.slipping && !regime.damped));
    grow(-0.2);
    CHECK((H == -1.0 && regime.slipping && !regime.damped));
    grow(0.5);  // below the kinetic bound: sticks
    CHECK((H == -0.5 && !regime.slipping && regime.damped));
}
