// SPDX-License-Identifier: GPL-3.0-or-later
/// Ode, the interface to GSL's rk8pd.

#include "reference/solvers/ode.hpp"
#include "tests/reference/solvers/oscillator.hpp"

#include "lie/check.hpp"

#include <catch2/catch.hpp>

#include <limits>

using namespace hilda;
using namespace hilda::reference;
using tests::oscillator;

TEST_CASE("rk8pd integrates an oscillator to rounding error and stops exactly at the end", "[reference][ode]")
{
    Ode ode(2, oscillator);
    Eigen::Vector2d y(1, 0);
    double t = 0;
    for (const double end : {0.1, 0.1, 1.0, 20.0}) {
        double last = t;
        ode.advance(t, y, end, [&](double at, const ConstVectorRef& there) {
            CHECK(at > last);
            CHECK(there[0] == Approx(std::cos(at)).margin(1e-12));
            last = at;
        });
        CHECK(t == end);
        CHECK(last == end);  // also called for the last step; not called for an empty interval
        CHECK((y - Eigen::Vector2d(std::cos(t), -std::sin(t))).norm() < 1e-12);
    }
    CHECK(ode.evaluations() > 100);
}

TEST_CASE("the next call of advance starts at a state that was changed between the calls", "[reference][ode]")
{
    Ode ode(2, oscillator);
    Eigen::Vector2d y(1, 0);
    double t = 0;
    ode.advance(t, y, 0.5);
    y << 0, 3;
    ode.advance(t, y, 1.5);
    CHECK((y - 3 * Eigen::Vector2d(std::sin(1.0), std::cos(1.0))).norm() < 1e-13);
}

TEST_CASE("an exception of the right-hand side propagates through GSL", "[reference][ode]")
{
    struct Unusual {
        double t;
    };
    Ode ode(1, [](double t, const ConstVectorRef&, VectorRef ydot) {
        if (t > 0.3) throw Unusual{t};
        ydot[0] = 1;
    });
    Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
    double t = 0;
    CHECK_THROWS_AS(ode.advance(t, y, 1.0), Unusual);
    CHECK(t <= 0.3);
    CHECK(y[0] == Approx(t));
    // the object can be used again
    t = 0, y[0] = 0;
    ode.advance(t, y, 0.25);
    CHECK(y[0] == Approx(0.25));
}

TEST_CASE("a right-hand side that is not finite and a solution with a pole are numerical failures",
          "[reference][ode]")
{
    Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
    double t = 0;
    Ode nan(1, [](double, const ConstVectorRef&, VectorRef ydot) {
        ydot[0] = std::numeric_limits<double>::quiet_NaN();
    });
    CHECK_THROWS_AS(nan.advance(t, y, 1.0), lie::NonFinite);
    CHECK(t == 0);

    Ode pole(1,
             [](double, const ConstVectorRef& at, VectorRef ydot) { ydot[0] = at[0] * at[0]; });  // 1/(1 - t)
    CHECK_THROWS_AS(pole.advance(t, y, 2.0), lie::NumericalFailure);
    CHECK(t == Approx(1));
}

TEST_CASE("the ODE solver rejects invalid arguments", "[reference][ode]")
{
    CHECK_THROWS_WITH(Ode(0, oscillator),
                      Catch::Contains("number of unknowns must be at least one") && Catch::Contains("got 0"));
    CHECK_THROWS_WITH(Ode(2, oscillator, {.relative = -1e-3}),
                      Catch::Contains("tolerances must be positive"));
    Ode ode(2, oscillator);
    Eigen::Vector2d y(1, 0);
    double t = 1;
    CHECK_THROWS_WITH(ode.advance(t, y, 0.5), Catch::Contains("got 0.5"));
}
