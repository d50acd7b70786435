// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/bracket.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>

using namespace hilda;

TEST_CASE("the zero of a function that is flat, steep or jumps is located to the last digits",
          "[lie][bracket]")
{
    struct Function {
        const char* name;
        std::function<double(double)> g;  ///< of the distance from its zero
        int most;                         ///< evaluations
    };
    const Function functions[] = {
        {"line", [](double x) { return x; }, 4},
        {"smooth", [](double x) { return std::sin(x) + 0.3 * x * x; }, 10},
        {"cube", [](double x) { return x * x * x; }, 220},
        {"ninth power", [](double x) { return std::pow(x, 9); }, 220},
        {"flat on one side", [](double x) { return x * std::exp(-40 * x); }, 220},
        {"root", [](double x) { return std::copysign(std::sqrt(std::abs(x)), x); }, 220},
        {"jump", [](double x) { return x < 0 ? -1e-9 : 1.; }, 220},
        {"pole", [](double x) { return x == 0 ? 1e300 : 1 / x; }, 220},
        {"infinite", [](double x) { return x < 0 ? -1. : std::numeric_limits<double>::infinity(); }, 220},
        {"scale", [](double x) { return 1e-200 * x; }, 4}};
    constexpr double tolerance = 4 * std::numeric_limits<double>::epsilon();
    for (const Function& f : functions)
        for (const double zero : {0.5537, 1. / 3, 1e-9, 0.999999}) {
            CAPTURE(f.name, zero);
            int evaluations = 0;
            lie::Bracket bracket(0, f.g(-zero), 1, f.g(1 - zero));
            lie::narrow(bracket, tolerance, [&](double x) {
                ++evaluations;
                return f.g(x - zero);
            });
            CHECK(std::abs(bracket.b - zero) <= tolerance);
            CHECK(evaluations <= f.most);
        }
    lie::Bracket bracket(0, -1, 1, 1);
    CHECK_THROWS_AS(lie::narrow(bracket, tolerance, [](double) { return std::nan(""); }),
                    lie::NumericalFailure);
}
