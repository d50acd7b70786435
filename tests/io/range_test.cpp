// SPDX-License-Identifier: GPL-3.0-or-later
/// Interval arithmetic, and the parts of expressions where they are not smooth.

#include "io/arithmetic/range.hpp"
#include "io/expression.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

using namespace hilda::io;

TEST_CASE("bounds of a function and of its derivative contain all values", "[io][range]")
{
    const std::vector<std::string> texts = {"t",
                                            "-t",
                                            "t+2*t^2-t^3",
                                            "1/(2+t)",
                                            "t/(t^2+1)",
                                            "sin(3*t)",
                                            "cos(t-1)",
                                            "tan(0.3*t)",
                                            "exp(-t^2)",
                                            "log(5+t)",
                                            "sqrt(5+t)",
                                            "abs(t)",
                                            "min(t,1-t)",
                                            "max(sin(t),0.2)",
                                            "step(t-0.3)",
                                            "if(t-0.3,t,2*t)",
                                            "atan(4*t)",
                                            "asin(t/9)",
                                            "acos(t/9)",
                                            "sinh(t)",
                                            "cosh(t)",
                                            "tanh(3*t)",
                                            "(5+t)^1.5",
                                            "(5+t)^-0.5",
                                            "t^4",
                                            "t^-2",
                                            "exp(-((t-0.5)/0.01)^2)*sin(t)"};
    std::mt19937 random(1);
    std::uniform_real_distribution<double> centre(-4, 4), exponent(-8, 1);
    for (const std::string& text : texts) {
        const Expression f(text);
        for (int n = 0; n < 200; ++n) {
            const double a = centre(random), b = std::min(4., a + std::pow(10., exponent(random)));
            const RangeJet bounds = f.bounds({a, b});
            for (int k = 0; k <= 20; ++k) {
                const double t = std::min(b, a + (b - a) * k / 20);
                const Jet at = f.jet(t);
                INFO(text << " at t = " << t << " in [" << a << ", " << b << "]");
                if (std::isfinite(at.f)) REQUIRE(bounds.f.contains(at.f));
                // The derivative itself has a rounding error, for example in 1 - tanh².
                const double rounding = 1e-14 * (1 + std::abs(at.fdot));
                const Range around{bounds.fdot.lo - rounding, bounds.fdot.hi + rounding};
                if (std::isfinite(at.fdot)) REQUIRE(around.contains(at.fdot));
            }
        }
    }
}

TEST_CASE("bounds of functions that occur once are exact", "[io][range]")
{
    const auto f = [](const char* text, double a, double b) { return Expression(text).bounds({a, b}).f; };
    CHECK(f("sin(t)", 0, 10).hi == 1);
    CHECK(f("sin(t)", 0.1, 0.2).hi == Approx(std::sin(0.2)).epsilon(1e-15));
    CHECK(f("sin(t)", 1, 2).hi == 1);
    CHECK(f("cos(t)", 3, 4).lo == -1);
    CHECK(f("t^2", -1, 2).lo == 0);
    CHECK(f("exp(-t^2)", -1, 2).hi == Approx(1).epsilon(1e-15));
    CHECK(f("cosh(t)", -1, 2).lo == Approx(1).epsilon(1e-15));
    CHECK(std::isinf(f("1/t", -1, 1).hi));
}

TEST_CASE("switching functions are the arguments of functions with kinks and jumps", "[io][expression]")
{
    const auto count = [](const char* text, Expression::Switches which = Expression::Switches::all) {
        return Expression(text, {"l", "ldot", "t"}).switching_functions(which).size();
    };
    CHECK(count("l+sin(t)") == 0);
    CHECK(count("step(t-1)*l") == 1);
    CHECK(count("step(2)*l") == 0);  // constant
    CHECK(count("if(l-1,abs(ldot),min(l,t))") == 3);
    CHECK(count("if(l-1,abs(ldot),min(l,t))", Expression::Switches::jumps) == 1);
    CHECK(count("asin(sin(t))") == 2);

    const std::vector<Expression> g = Expression("max(t^2,1+t)").switching_functions();
    REQUIRE(g.size() == 1);
    for (const double t : {-1., 0.5, 3.}) CHECK(g[0].value(t) == t * t - (1 + t));
    const std::vector<Expression> ends = Expression("asin(2*t)").switching_functions();
    REQUIRE(ends.size() == 2);
    CHECK(ends[0].value(0.25) * ends[1].value(0.25) == -0.75);  // (2 t + 1)(2 t - 1)
}

TEST_CASE("the largest parts of an expression in one variable", "[io][expression]")
{
    const std::vector<std::string> names = {"l", "ldot", "t"};
    const auto parts = [&](const char* text) { return Expression(text, names).parts_in(2); };
    CHECK(parts("l*ldot").empty());
    CHECK(parts("t*l").empty());
    REQUIRE(parts("step(t-1)*l+sin(2*t)").size() == 2);
    CHECK(parts("step(t-1)*l+sin(2*t)")[0].value(1.5) == 1);
    CHECK(parts("step(t-1)*l+sin(2*t)")[1].value(1.5) == std::sin(3.));
    REQUIRE(parts("exp(-t)*sin(t)").size() == 1);
    CHECK(parts("exp(-t)*sin(t)")[0].value(2) == std::exp(-2.) * std::sin(2.));
    CHECK(Expression("3*t^2").parts_in(0)[0].value(2) == 12);
}
