// SPDX-License-Identifier: GPL-3.0-or-later
/// Impacts in closed form: mutual consistency, momentum, energy and limit cases.

#include "reference/motions/bounce.hpp"

#include "lie/check.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::reference;

TEST_CASE("a dropped ball bounces at the times of a geometric series and then remains at rest",
          "[reference][bounce]")
{
    const double e = GENERATE(0.0, 0.5, 0.9);
    const BouncingBall ball{.R = 0.5, .e = e, .r = Vec3(1, 2, 1.5), .m = 2};
    const double t_1 = std::sqrt(2 / 9.81), w = std::sqrt(2 * 9.81);  // a fall of 1 m
    CHECK(ball.impact_time(1) == Approx(t_1).epsilon(1e-15));
    CHECK(ball.impact_time(2) == Approx(t_1 * (1 + 2 * e)).epsilon(1e-14));
    CHECK(ball.impact_time(3) == Approx(t_1 * (1 + 2 * e + 2 * e * e)).epsilon(1e-14));
    CHECK(ball.rest_time() == Approx(t_1 * (1 + e) / (1 - e)).epsilon(1e-14));
    CHECK(ball.impulse(1) == Approx(2 * (1 + e) * w).epsilon(1e-15));
    if (e > 0) {
        for (int k = 1; k <= 5; ++k) {
            const double t = ball.impact_time(k), peak = t + std::pow(e, k) * w / 9.81;
            CHECK(ball.at(t * (1 + 1e-14)).r.z() == Approx(0.5).epsilon(1e-12));
            CHECK(ball.at(peak).r.z() == Approx(0.5 + std::pow(e, 2 * k)).epsilon(1e-13));
            const double gravity = 9.81 * 2e-9,
                         jump = ball.at(t + 1e-9).rdot.z() - ball.at(t - 1e-9).rdot.z() + gravity;
            CHECK(2 * jump == Approx(ball.impulse(k)).epsilon(1e-13));
        }
    }
    const Motion rest = ball.at(ball.rest_time() + 1);
    CHECK((rest.r - Vec3(1, 2, 0.5)).norm() < 1e-15);
    CHECK(rest.rdot.norm() == 0);
    CHECK(rest.rddot.norm() < 1e-15);
    CHECK(ball.resting_force() == Approx(2 * 9.81).epsilon(1e-15));
}

TEST_CASE("a ball on a slope bounces along the normal and accelerates along the slope", "[reference][bounce]")
{
    tests::Random random(GENERATE(1u, 2u));
    const double alpha = 0.4;
    const Vec3 n(0, std::sin(alpha), std::cos(alpha)), down(0, std::cos(alpha), -std::sin(alpha));
    const Vec3 v = random.vector(2);
    const BouncingBall ball{.n = n, .R = 0.2, .e = 0.6, .r = Vec3(0, 0, 2), .rdot = v};
    for (const double t : {0.1, 0.8, 1.5, 2.4, ball.rest_time() + 0.3}) {
        const Motion x = ball.at(t);
        CHECK(x.rdot.dot(down) == Approx(v.dot(down) + 9.81 * std::sin(alpha) * t).epsilon(1e-13));
        CHECK(x.rdot.x() == Approx(v.x()).epsilon(1e-13));
        CHECK(n.dot(x.r) > 0.2 - 1e-14);
        // between impacts ṙ is the derivative of r
        CHECK(((ball.at(t + 1e-5).r - ball.at(t - 1e-5).r) / 2e-5 - x.rdot).norm() < 1e-8);
    }
    // free flight up to the first impact
    const Flight flight{.r = ball.r, .rdot = v};
    CHECK(flight.landing_time(n, 0.2).value() == Approx(ball.impact_time(1)).epsilon(1e-14));
    CHECK((flight.at(0.5 * ball.impact_time(1)) - ball.at(0.5 * ball.impact_time(1)).r).norm() < 1e-14);
    // e = 1 conserves energy
    const BouncingBall elastic{.n = n, .R = 0.2, .e = 1, .r = ball.r, .rdot = v};
    const auto energy = [](const Motion& x) { return 0.5 * x.rdot.squaredNorm() + 9.81 * x.r.z(); };
    CHECK(std::isinf(elastic.rest_time()));
    CHECK(energy(elastic.at(20)) == Approx(energy(elastic.at(0))).epsilon(1e-12));
}

TEST_CASE("a flight reaches a plane only with a velocity towards it", "[reference][bounce]")
{
    const Flight flight{.r = Vec3(0, 0, 1), .rdot = Vec3(3, 0, 2)};
    const double t = flight.landing_time(Vec3::UnitZ(), 0.2).value();
    CHECK(flight.at(t).z() == Approx(0.2).epsilon(1e-14));
    CHECK(flight.velocity(t).z() == Approx(-std::sqrt(4 + 2 * 9.81 * 0.8)).epsilon(1e-14));
    CHECK_FALSE(flight.landing_time(Vec3::UnitZ(), 2).has_value());  // above the top of the trajectory
    CHECK(Flight{.rdot = Vec3(0, 0, -2), .gravity = Vec3::Zero()}.landing_time(Vec3::UnitZ(), -1).value() ==
          0.5);
    CHECK_FALSE(
        Flight{.rdot = Vec3(0, 0, 2), .gravity = Vec3::Zero()}.landing_time(Vec3::UnitZ(), -1).has_value());
}

TEST_CASE("the collision of two balls conserves momentum and loses the energy given by the restitution",
          "[reference][bounce]")
{
    const double e = GENERATE(0.0, 0.7, 1.0);
    const TwoBalls balls{.one = {0.5, 2, Vec3(0, 0, 0), Vec3(1, 0, 2)},
                         .two = {0.3, 1, Vec3(3, 0.4, 0.1), Vec3(-2, 0, 2)},
                         .e = e,
                         .gravity = Vec3(0, 0, -9.81)};
    REQUIRE(balls.collision_time().has_value());
    const double t = *balls.collision_time(), after = t + 0.2;
    const auto [a, b] = balls.at(t);
    const Vec3 n = balls.normal();
    CHECK((b.r - a.r).norm() == Approx(0.8).epsilon(1e-14));
    CHECK((b.r - a.r - 0.8 * n).norm() < 1e-14);
    const Vec3 before(-3, 0, 0), relative = b.rdot - a.rdot;
    CHECK(n.dot(relative) == Approx(-e * n.dot(before)).margin(1e-14));
    CHECK((relative - n.dot(relative) * n - before + n.dot(before) * n).norm() < 1e-14);
    const auto [c, d] = balls.at(after);
    const Vec3 P = 2 * c.rdot + d.rdot;
    CHECK((P - (Vec3(0, 0, 6) + 3 * after * Vec3(0, 0, -9.81))).norm() < 1e-13);
    CHECK((d.r - c.r - (b.r - a.r) - 0.2 * relative).norm() < 1e-14);
    const double mu = 2.0 / 3, lost = 0.5 * mu * (before.squaredNorm() - relative.squaredNorm());
    CHECK(lost == Approx(0.5 * mu * (1 - e * e) * n.dot(before) * n.dot(before)).margin(1e-13));
    CHECK(balls.impulse() == Approx(-mu * (1 + e) * n.dot(before)).epsilon(1e-14));
}

TEST_CASE("equal balls exchange their velocities in a central elastic collision", "[reference][bounce]")
{
    const TwoBalls balls{.one = {0.5, 1, Vec3::Zero(), Vec3(2, 0, 0)},
                         .two = {0.5, 1, Vec3(3, 0, 0), Vec3(-1, 0, 0)}};
    CHECK(balls.collision_time().value() == Approx(2.0 / 3).epsilon(1e-15));
    const auto [a, b] = balls.at(1);
    CHECK((a.rdot - Vec3(-1, 0, 0)).norm() < 1e-15);
    CHECK((b.rdot - Vec3(2, 0, 0)).norm() < 1e-15);

    TwoBalls miss = balls;
    miss.two.r.y() = 1.1;
    CHECK_FALSE(miss.collision_time().has_value());
    CHECK(miss.impulse() == 0);
    CHECK((miss.at(1).first.rdot - Vec3(2, 0, 0)).norm() == 0);
    CHECK_THROWS_AS(miss.normal(), lie::NumericalFailure);
}

TEST_CASE("invalid impacts are rejected with the value", "[reference][bounce]")
{
    using Catch::Contains;
    CHECK_THROWS_WITH((BouncingBall{.e = 1.5}.at(1)), Contains("between 0 and 1") && Contains("got 1.5"));
    CHECK_THROWS_WITH((BouncingBall{.n = Vec3(0, 0, 2)}.at(1)), Contains("unit vector"));
    CHECK_THROWS_WITH((BouncingBall{.r = Vec3(0, 0, 0.4)}.at(1)), Contains("gap must be positive"));
    CHECK_THROWS_WITH((BouncingBall{.gravity = Vec3(0, 0, 1)}.at(1)), Contains("towards the plane"));
    CHECK_THROWS_WITH(BouncingBall().impact_time(0), Contains("counted from 1"));
    CHECK_THROWS_WITH((TwoBalls{.one = {}, .two = {}}.collision_time()),
                      Contains("must not be in contact at the start"));
}
