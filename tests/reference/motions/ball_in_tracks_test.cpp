// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball in a cylinder, on a sphere and in a groove: equations of motion, closed forms compared with
/// integration, invariants.

#include "reference/motions/ball_in_cylinder.hpp"
#include "reference/motions/ball_in_groove.hpp"
#include "reference/motions/ball_on_sphere.hpp"
#include "reference/motions/bounce.hpp"

#include "lie/check.hpp"
#include "tests/reference/contact_motion.hpp"

using namespace hilda;
using namespace hilda::reference;

TEST_CASE("the height of a ball that rolls in a vertical cylinder oscillates",
          "[reference][cylinder][acceptance]")
{
    const BallInCylinder cylinder;
    CHECK(cylinder.slide({0, 1})[1].F_N == Approx(13.5).epsilon(1e-15));
    CHECK(cylinder.nu() == Approx(3 * std::sqrt(2.0 / 7)).epsilon(1e-15));
    CHECK(2 * cylinder.z_eq() == Approx(-5.45).epsilon(1e-15));
    for (const ContactInstant& x : cylinder.roll({0.5, 1.7, 4})) {
        const double z = cylinder.z_eq() * (1 - std::cos(3 * std::sqrt(2.0 / 7) * x.t));
        CHECK(x.body.r.z() == Approx(z).epsilon(1e-14));
        CHECK(x.F_N == Approx(13.5).epsilon(1e-15));
    }
}

TEST_CASE("the motions in the cylinder satisfy the equations of motion", "[reference][cylinder]")
{
    const double Omega = GENERATE(3.0, -2.0);
    const BallInCylinder cylinder{.R = 0.4, .m = 1.3, .Omega = Omega, .zdot = 0.7, .spin = -4};
    const Mat3 J_bar = cylinder.J * Mat3::Identity();
    const double rate = 12, h = 4e-3 / rate;
    const auto instants = tests::five_instants(0.8, h);
    const auto roll = cylinder.roll(instants), slide = cylinder.slide(instants);
    for (const auto& run : {slide, roll}) tests::check_motion(run, h, 1.3, J_bar, 9.81, rate);
    CHECK(roll[2].slip().norm() < 1e-13);
    CHECK(slide[2].F_t.norm() < 1e-14);
    CHECK(slide[2].p.head<2>().norm() == Approx(2).epsilon(1e-15));

    const auto start = cylinder.roll({0})[0];
    CHECK(start.n.dot(start.body.A * start.body.omega_bar) == Approx(-4).epsilon(1e-14));
    CHECK(start.body.rdot.z() == Approx(0.7).epsilon(1e-14));
    const auto energy = [&](const ContactInstant& x) {
        return 0.65 * x.body.rdot.squaredNorm() + 0.5 * cylinder.J * x.body.omega_bar.squaredNorm() +
               1.3 * 9.81 * x.body.r.z();
    };
    CHECK(energy(roll[2]) == Approx(energy(start)).epsilon(1e-13));

    CHECK_THROWS_WITH((BallInCylinder{.R = 2}.roll({1})), Catch::Contains("fit into the cylinder"));
    CHECK_THROWS_WITH((BallInCylinder{.Omega = 0}.roll({1})), Catch::Contains("Omega must not be zero"));
    CHECK_THROWS_WITH(cylinder.roll({1, 0.5}), Catch::Contains("ascend"));
}

TEST_CASE("a ball lifts off the sphere at the angle and time of the energy balance",
          "[reference][sphere][acceptance]")
{
    const BallOnSphere ball;
    CHECK(ball.slide_cosine() == Approx(2.0 / 3 + 0.04 / (3 * 9.81 * 1.3)).epsilon(1e-15));
    CHECK(ball.slide_cosine() == Approx(0.66771217).margin(5e-9));
    CHECK(ball.roll_cosine() == Approx((1 + 0.7 * 0.04 / (9.81 * 1.3)) / 1.7).epsilon(1e-15));
    CHECK(ball.roll_cosine() == Approx(0.5895268).margin(5e-8));

    const DescentResult slide = ball.slide({}), roll = ball.roll({});
    CHECK(slide.body.r.z() / 1.3 == Approx(ball.slide_cosine()).epsilon(1e-13));
    CHECK(roll.body.r.z() / 1.3 == Approx(ball.roll_cosine()).epsilon(1e-13));
    CHECK(slide.t == Approx(ball.slide_time()).epsilon(1e-13));
    CHECK(roll.t == Approx(ball.roll_time()).epsilon(1e-13));
    CHECK(slide.body.rdot.squaredNorm() == Approx(9.81 * 1.3 * ball.slide_cosine()).epsilon(1e-13));
    CHECK(roll.body.omega_bar.x() == Approx(-roll.body.rdot.norm() / 0.3).epsilon(1e-13));
    CHECK(slide.body.omega_bar.norm() == 0);

    // above the velocity of immediate lift-off
    const DescentResult fast = BallOnSphere{.v_0 = 4}.slide({0.5});
    CHECK(fast.t == 0);
    CHECK((fast.instant[0].body.r - Vec3(0, 2, 1.3 - 9.81 / 8)).norm() < 1e-14);
}

TEST_CASE("the motions on the sphere satisfy the equations of motion", "[reference][sphere]")
{
    const BallOnSphere ball{.m = 1.3};
    const Mat3 J_bar = ball.J * Mat3::Identity();
    const double rate = 10, h = 4e-3 / rate, mu = 0.3;
    const DescentResult slipped = ball.stick_slip(mu, {});
    REQUIRE(slipped.t_slip < slipped.t);
    const double t_roll = slipped.t_slip / 2, t_slide = (slipped.t_slip + slipped.t) / 2,
                 t_flight = slipped.t + 0.1;
    for (const auto& run : {ball.slide(tests::five_instants(0.5, h)), ball.roll(tests::five_instants(0.5, h)),
                            ball.stick_slip(mu, tests::five_instants(t_roll, h)),
                            ball.stick_slip(mu, tests::five_instants(t_slide, h))})
        tests::check_motion(run.instant, h, ball.m, J_bar, 9.81, rate);
    CHECK(ball.roll({0.5}).instant[0].slip().norm() < 1e-12);

    const ContactInstant stuck = ball.stick_slip(mu, {t_roll}).instant[0],
                         slid = ball.stick_slip(mu, {t_slide}).instant[0];
    CHECK(stuck.slip().norm() < 1e-12);
    CHECK((stuck.body.r - ball.roll({t_roll}).instant[0].body.r).norm() < 1e-12);
    CHECK(slid.F_t.norm() == Approx(mu * slid.F_N).epsilon(1e-13));
    CHECK(slid.F_t.normalized().dot(slid.slip().normalized()) == Approx(-1).epsilon(1e-12));

    // the constant C of the closed form is constant during slip
    const auto C = [&](const Motion& body) {
        const double angle = std::atan2(body.r.y(), body.r.z()), scale = 2 * 9.81 * 1.3 / (1 + 4 * mu * mu);
        const double path = scale * ((1 - 2 * mu * mu) * std::cos(angle) + 3 * mu * std::sin(angle));
        return (body.rdot.squaredNorm() + path) * std::exp(-2 * mu * angle);
    };
    CHECK(C(slid.body) == Approx(C(slipped.body)).epsilon(1e-13));
    CHECK(C(ball.roll({slipped.t_slip}).instant[0].body) == Approx(C(slipped.body)).epsilon(1e-13));

    // free flight: no contact force, parabolic trajectory
    const auto flight = ball.stick_slip(mu, {t_flight}).instant[0];
    const Vec3 fallen = slipped.body.r + 0.1 * slipped.body.rdot - 0.005 * Vec3(0, 0, 9.81);
    CHECK((flight.body.r - fallen).norm() < 1e-13);
    CHECK(flight.F().norm() == 0);
    CHECK(flight.body.r.norm() > 1.3);
    CHECK((flight.body.omega_bar - slipped.body.omega_bar).norm() < 1e-13);
}

TEST_CASE("a ball on the sphere slips before lift-off, and later with more friction", "[reference][sphere]")
{
    // rolling: F_t = 2/7 m g sin θ, F_N = m g cos θ - m v²/(R + r); slip starts at F_t = μ F_N
    const BallOnSphere ball;
    const double slide = ball.slide_time(), roll = ball.roll_time();
    double t_slip = 0;
    for (const double mu : {1e-6, 0.1, 0.5, 2.0, 50.0}) {
        const DescentResult run = ball.stick_slip(mu, {});
        CHECK(run.t_slip > t_slip);
        CHECK(run.t_slip < run.t);
        t_slip = run.t_slip;
        // onset of slip: (J/(J + m r²)) sin θ = μ (cos θ - v²/(g (R + r))) with v² from the energy
        const ContactInstant onset = ball.roll({t_slip}).instant[0];
        CHECK(onset.F_t.norm() == Approx(mu * onset.F_N).epsilon(1e-9));
    }
    // limits of small and large friction: sliding and rolling
    CHECK(ball.stick_slip(1e-9, {}).t == Approx(slide).epsilon(1e-8));
    CHECK(ball.stick_slip(1e4, {}).t == Approx(roll).epsilon(1e-4));
    CHECK_THROWS_WITH(ball.stick_slip(0, {}), Catch::Contains("use slide() without friction"));
    CHECK_THROWS_WITH((BallOnSphere{.v_0 = 0}.roll({})), Catch::Contains("v_0 must be positive"));
}

TEST_CASE("the flight after lift-off from the sphere is the parabola of a free flight",
          "[reference][sphere][bounce]")
{
    const DescentResult run = BallOnSphere().slide({});
    const Flight flight{.r = run.body.r, .rdot = run.body.rdot};
    const std::optional<double> fall =
        flight.landing_time(Vec3::UnitZ(), -1 + 0.3);  // the floor is at z = -1
    REQUIRE(fall.has_value());
    const Vec3 there = BallOnSphere().slide({run.t + *fall}).instant[0].body.r;
    CHECK(there.z() == Approx(-0.7).epsilon(1e-13));
    CHECK((there - flight.at(*fall)).norm() < 1e-13);
    CHECK(there.y() > run.body.r.y());
}

TEST_CASE("a ball in a groove stays on its steady orbit", "[reference][groove][acceptance]")
{
    const BallInGroove groove{.R_t = 2, .a = 1, .R = 0.4, .m = 1.5};
    for (const double beta : {0.0, 0.3, 1.2}) {
        const double Omega = groove.steady_rate(beta);
        CHECK(Omega * Omega == Approx(9.81 * std::tan(beta) / (2 + 0.6 * std::sin(beta))).margin(1e-15));
        for (const ContactInstant& x : groove.slide({.beta = beta, .phidot = Omega}, {0, 1, 5})) {
            CHECK(x.F_N == Approx(1.5 * 9.81 / std::cos(beta)).epsilon(1e-12));
            CHECK(x.body.r.z() == Approx(-0.6 * std::cos(beta)).epsilon(1e-12));
            CHECK(std::remainder(std::atan2(x.body.r.y(), x.body.r.x()) - Omega * x.t, 8 * std::atan(1.0)) ==
                  Approx(0).margin(1e-11));
        }
    }
    CHECK_THROWS_WITH(groove.steady_rate(2), Catch::Contains("steady orbit"));
    CHECK_THROWS_WITH((BallInGroove{.R = 1}.slide({}, {1})), Catch::Contains("R < a < R_t"));
}

TEST_CASE("a ball in a groove conserves energy and angular momentum", "[reference][groove]")
{
    const BallInGroove groove{.m = 1.3};
    const BallInGroove::InitialState start{
        .beta = 0.4, .betadot = -1, .phidot = 2.5, .omega = Vec3(1, 2, -3)};
    const double rate = 10, h = 4e-3 / rate;
    tests::check_motion(groove.slide(start, tests::five_instants(0.7, h)), h, 1.3,
                        groove.J * Mat3::Identity(), 9.81, rate);
    const auto energy = [](const ContactInstant& x) {
        return 0.5 * x.body.rdot.squaredNorm() + 9.81 * x.body.r.z();
    };
    const auto L_z = [](const ContactInstant& x) { return x.body.r.cross(x.body.rdot).z(); };
    const auto run = groove.slide(start, {0, 1, 3, 8});
    for (const ContactInstant& x : run) {
        CHECK(energy(x) == Approx(energy(run[0])).epsilon(1e-12));
        CHECK(L_z(x) == Approx(L_z(run[0])).epsilon(1e-12));
        const Vec3 middle = 2 * Vec3(x.p.x(), x.p.y(), 0).normalized();
        CHECK((x.p - middle).norm() == Approx(1).epsilon(1e-14));
    }
}
