// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/driver.hpp"

#include <catch2/catch.hpp>

#include <limits>

using namespace hilda;
using hilda::dae::Driver;

TEST_CASE("a driver is zero, a number or an expression", "[dae][driver]")
{
    CHECK(Driver().f(3) == 0);
    CHECK(Driver().is_constant());
    CHECK(Driver(0).text() == "0");
    CHECK(Driver().text() == "0");
    for (double c : {-2.5, 0.1, 1. / 3, 1e-300, -5e-324, 1.7976931348623157e308}) {
        CHECK(Driver(c).f(3) == c);
        CHECK(Driver(c).fdot(3) == 0);
        CHECK(Driver(c).fddot(3) == 0);
    }
    CHECK(Driver("t^2").fdot(3) == 6);
    CHECK(Driver("t^2").text() == "t^2");
    const Driver f("cos(2*t)");
    const io::Jet j = f.jet(0.7);
    CHECK(f.f(0.7) == j.f);
    CHECK(f.fdot(0.7) == j.fdot);
    CHECK(f.fddot(0.7) == j.fddot);
    CHECK_FALSE(Driver("t^2").is_constant());
    CHECK_THROWS_AS(Driver(std::numeric_limits<double>::infinity()), io::ExpressionError);
    CHECK_THROWS_AS(Driver(std::numeric_limits<double>::quiet_NaN()), io::ExpressionError);
}

TEST_CASE("the complement of a cosine is the sine of the same angle", "[dae][driver]")
{
    for (const char* text : {"cos(pi/2 + pi/4*cos(2*t))", "sin(2*pi*t)", "  +( cos (-2*t) )",
                             "cos(sin(t)+cos(t))", "sin(asin(t/2))"}) {
        const Driver f(text);
        const auto g = f.complement();
        REQUIRE(g);
        for (double t : {0., 0.3, 1.7}) {
            const io::Jet a = f.jet(t), b = g->jet(t);
            INFO(text << " and " << g->text() << " at t = " << t);
            CHECK(a.f * a.f + b.f * b.f == Approx(1).epsilon(1e-15));
            CHECK(a.f * a.fdot + b.f * b.fdot == Approx(0).margin(1e-14));
        }
        CHECK(g->complement()->text() == text);
    }
    CHECK(Driver("cos(pi/2 + pi/4*cos(2*t))").complement()->text() == "sin(pi/2 + pi/4*cos(2*t))");
    CHECK(Driver("sin(t)").complement()->f(0) == 1);
    for (const char* text : {"0", "cos(pi/3)", "-cos(t)", "2*cos(t)", "cos(t)^2", "acos(t)", "cosh(t)", "t"})
        CHECK_FALSE(Driver(text).complement());
}
