// SPDX-License-Identifier: GPL-3.0-or-later
/// Event location and oscillation periods, compared with the harmonic oscillator and the elliptic integral.

#include "reference/solvers/event.hpp"
#include "reference/motions/swing_period.hpp"
#include "tests/reference/solvers/oscillator.hpp"

#include "lie/check.hpp"

#include <gsl/gsl_sf_ellint.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace hilda;
using namespace hilda::reference;
using tests::oscillator;

namespace {

using std::numbers::pi;

}  // namespace

TEST_CASE("an event is located to rounding error and only at a decreasing zero", "[reference][event]")
{
    Ode ode(2, oscillator);
    Eigen::VectorXd y(2);
    y << 0, 1;  // y = sin t
    double t = 0;
    const Event position = [](double, const ConstVectorRef& now) { return now[0]; };
    // zero at the start; decreasing zeros at π and 3π, increasing at 2π
    REQUIRE(advance_to_event(ode, t, y, 100, 0.3, position));
    CHECK(t == Approx(pi).epsilon(1e-14));
    CHECK(std::abs(y[0]) < 1e-14);
    CHECK(y[1] == Approx(-1).epsilon(1e-13));
    REQUIRE(advance_to_event(ode, t, y, 100, 0.3, position));
    CHECK(t == Approx(3 * pi).epsilon(1e-14));

    CHECK_FALSE(advance_to_event(ode, t, y, 12, 0.3, position));
    CHECK(t == 12);
    CHECK(y[0] == Approx(std::sin(12)).margin(1e-12));
}

TEST_CASE("an event with a small negative part of the event function is found", "[reference][event]")
{
    // cos t + 1 - 1e-6 becomes negative at π - 1.4142e-3 and has the minimum -1e-6
    Ode ode(2, oscillator);
    Eigen::VectorXd y(2);
    y << 1, 0;  // y = cos t
    double t = 0;
    REQUIRE(advance_to_event(ode, t, y, 10, 5e-4,
                             [](double, const ConstVectorRef& now) { return now[0] + 1 - 1e-6; }));
    CHECK(t == Approx(std::acos(1e-6 - 1)).epsilon(1e-10));  // rounding error divided by the slope 1.4e-3
    CHECK_THROWS_AS(advance_to_event(ode, t, y, 10, 0, [](double, const ConstVectorRef&) { return 1.0; }),
                    lie::InvalidInput);
}

TEST_CASE("the period of a pendulum is the elliptic integral at every amplitude", "[reference][swing]")
{
    for (const double theta_0 : {1e-6, 0.1, 1.0, 2.5, 3.1}) {
        const double T = swing_period(
            theta_0, [](double) { return 1.0; }, [&](double theta, double remaining) {  // cos θ - cos θ_0
                return 2 * std::sin(remaining / 2) * std::sin((theta + theta_0) / 2);
            });
        CHECK(T == Approx(4 * gsl_sf_ellint_Kcomp(std::sin(theta_0 / 2), GSL_PREC_DOUBLE)).epsilon(1e-13));
    }
}

TEST_CASE("a period is rejected without an oscillation", "[reference][swing]")
{
    const auto M = [](double) { return 1.0; };
    CHECK_THROWS_AS(swing_period(0, M, [](double, double remaining) { return remaining; }),
                    lie::InvalidInput);
    CHECK_THROWS_AS(swing_period(1, M, [](double, double remaining) { return -remaining; }),
                    lie::InvalidInput);
    // an amplitude at an unstable equilibrium has an infinite period
    CHECK_THROWS_AS(swing_period(1, M, [](double, double remaining) { return remaining * remaining; }),
                    lie::NumericalFailure);
}
