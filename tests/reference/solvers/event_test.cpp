// SPDX-License-Identifier: GPL-3.0-or-later
/// Events and periods: against the pendulum, the oscillator and the elliptic integral.

#include "reference/solvers/event.hpp"
#include "reference/motions/swing_period.hpp"

#include "lie/check.hpp"

#include <gsl/gsl_sf_ellint.h>
#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::reference;

namespace {

constexpr double pi = 3.14159265358979323846;

void oscillator(double, const ConstVectorRef& y, VectorRef ydot)
{
    ydot[0] = y[1];
    ydot[1] = -y[0];
}

}  // namespace

TEST_CASE("an event is found to the last digits and only where it falls", "[reference][event]")
{
    Ode ode(2, oscillator);
    Eigen::VectorXd y(2);
    y << 0, 1;  // y = sin t
    double t = 0;
    const Event position = [](double, const ConstVectorRef& now) { return now[0]; };
    // zero at the start and at π, where it falls; it rises at 2π
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

TEST_CASE("an event that barely happens is found", "[reference][event]")
{
    // cos t + 1 - 1e-6 only just falls below zero, at π - 1.4142e-3
    Ode ode(2, oscillator);
    Eigen::VectorXd y(2);
    y << 1, 0;  // y = cos t
    double t = 0;
    REQUIRE(advance_to_event(ode, t, y, 10, 5e-4,
                             [](double, const ConstVectorRef& now) { return now[0] + 1 - 1e-6; }));
    CHECK(t == Approx(std::acos(1e-6 - 1)).epsilon(1e-10));  // ε over its slope of 1.4e-3
    CHECK_THROWS_AS(advance_to_event(ode, t, y, 10, 0, [](double, const ConstVectorRef&) { return 1.0; }),
                    lie::InvalidInput);
}

TEST_CASE("the period of a pendulum is the elliptic integral at every amplitude", "[reference][swing]")
{
    for (const double theta_0 : {1e-6, 0.1, 1.0, 2.5, 3.1}) {
        const double T = swing_period(
            theta_0, [](double) { return 1.0; }, [&](double theta, double to_go) {  // cos θ - cos θ_0
                return 2 * std::sin(to_go / 2) * std::sin((theta + theta_0) / 2);
            });
        CHECK(T == Approx(4 * gsl_sf_ellint_Kcomp(std::sin(theta_0 / 2), GSL_PREC_DOUBLE)).epsilon(1e-13));
    }
}

TEST_CASE("a swing that is none is refused", "[reference][swing]")
{
    const auto M = [](double) { return 1.0; };
    CHECK_THROWS_AS(swing_period(0, M, [](double, double to_go) { return to_go; }), lie::InvalidInput);
    CHECK_THROWS_AS(swing_period(1, M, [](double, double to_go) { return -to_go; }), lie::InvalidInput);
    // from the top of a hill it takes for ever
    CHECK_THROWS_AS(swing_period(1, M, [](double, double to_go) { return to_go * to_go; }),
                    lie::NumericalFailure);
}
