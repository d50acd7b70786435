// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions of time: break points, pulses within an interval, and the mean at a jump.

#include "dae/function_of_time.hpp"

#include "dae/curves/sampled_curve.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

using namespace hilda;
using dae::FunctionOfTime;
using dae::NodeFormula;

namespace {

std::vector<double> breaks(const std::string& text, double from, double to)
{
    const FunctionOfTime f{io::Expression(text)};
    std::vector<double> all;
    double t = from;
    while (all.size() < 100) {
        const std::optional<double> next = f.first_break(t, to);
        if (!next) break;
        all.push_back(*next);
        t = *next * (1 + 1e-13);
    }
    return all;
}

}  // namespace

TEST_CASE("break points of formulas are found to the last digits", "[dae][function_of_time]")
{
    const auto close = [](const std::vector<double>& found, const std::vector<double>& right) {
        REQUIRE(found.size() == right.size());
        for (size_t k = 0; k < right.size(); ++k) CHECK(std::abs(found[k] - right[k]) <= 4e-16 * right[k]);
    };
    close(breaks("step(t-1)-step(t-1.001)", 0, 1e6), {1, 1.001});
    close(breaks("if(0.5e-6-abs(t-2),10,0)", 0, 10), {2 - 0.5e-6, 2, 2 + 0.5e-6});
    close(breaks("max(0,sin(2*pi*t))", 0.25, 3.25), {0.5, 1, 1.5, 2, 2.5, 3});
    close(breaks("min(t,2-t)", 0, 5), {1});
    close(breaks("abs(t^2-2)", 0, 9), {std::numbers::sqrt2});
    CHECK(breaks("sin(t)*exp(-t)+t^3", 0, 1e9).empty());
    CHECK(breaks("max(0,t^2+1)", 0, 1e3).empty());
    CHECK(breaks("abs(sin(t)-sin(t))", 0, 10).empty());
    CHECK(breaks("step(t-1)", 1, 10).empty());  // after the break point
    // The double zeros of a triangular wave are found to the square root of the precision, several times.
    std::vector<double> triangle = breaks("asin(sin(t))", 0.1, 8);
    triangle.erase(std::unique(triangle.begin(), triangle.end(),
                               [](double a, double b) { return std::abs(b - a) < 1e-6; }),
                   triangle.end());
    REQUIRE(triangle.size() == 3);
    for (size_t k = 0; k < 3; ++k)
        CHECK(triangle[k] == Approx((0.5 + static_cast<double>(k)) * std::numbers::pi).epsilon(1e-7));
}

TEST_CASE("windows at random places are found, however short", "[dae][function_of_time]")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(0.1, 900), width(-7, 1);
    for (int n = 0; n < 100; ++n) {
        const double a = place(random), b = a + std::pow(10., width(random));
        const std::string from = std::to_string(a), to = std::to_string(b);
        const std::vector<double> found = breaks("5*(step(t-" + from + ")-step(t-" + to + "))", 0, 1000);
        const double first = std::stod(from), last = std::stod(to);
        REQUIRE(found.size() == (first == last ? 1u : 2u));
        CHECK(std::abs(found.front() - first) <= 4e-16 * first);
        CHECK(std::abs(found.back() - last) <= 4e-16 * last);
    }
}

TEST_CASE("an interval without pulses is resolved, one with a pulse ends before it",
          "[dae][function_of_time]")
{
    const auto until = [](const std::string& text, double from, double to) {
        return FunctionOfTime{io::Expression(text)}.resolved_until(from, to);
    };
    CHECK(until("3*t^2", 0, 1e5) == 1e5);
    CHECK(until("sin(t)", 0, 3) == 3);
    CHECK(until("tanh(1e3*(t-1))", 0, 10) == 10);  // monotone
    CHECK(until("sin(t)", 0, 100) < 10);
    for (const double width : {1., 1e-2, 1e-4, 1e-6}) {
        const std::string text = "exp(-((t-100)/" + io::Expression(std::to_string(width)).text() + ")^2)";
        if (width < 1e-5) continue;  // digits of to_string
        INFO(text);
        double t = 0;
        for (int steps = 0; t < 100 - 3 * width; ++steps) {
            const double next = until(text, t, 1000);
            REQUIRE(next > t);
            // It ends before the pulse, or is short enough to see it.
            REQUIRE((next < 100 - width || next - t < 10 * width));
            REQUIRE(steps < 100);
            t = next;
        }
        // Inside, intervals of a few widths only
        CHECK(until(text, 100 - 3 * width, 1000) - 100 < 8 * width);
    }
}

TEST_CASE("a pulse of samples is resolved", "[dae][function_of_time]")
{
    std::vector<double> t, f;
    for (int k = 0; k <= 1000; ++k) {
        t.push_back(0.01 * k);
        f.push_back(std::exp(-std::pow((t.back() - 5) / 0.05, 2)));
    }
    const FunctionOfTime curve(std::make_shared<dae::SampledCurve>(t, f));
    CHECK(curve.resolved_until(0, 10) < 5);
    CHECK(curve.resolved_until(0, 10) > 1);
    CHECK_FALSE(curve.first_break(0, 10));
}

TEST_CASE("a formula at its jump is the mean of both sides, and the later one at the start",
          "[dae][function_of_time]")
{
    const auto at = [](const std::string& text, double t, double start = 0) {
        return NodeFormula(io::Expression(text), 0).value(t, start);
    };
    CHECK(at("10*step(t-1)", 1) == 5);
    CHECK(at("10*step(t-1)", 1 + 1e-12) == 10);
    CHECK(at("10*step(t-1)", 1 - 1e-12) == 0);
    CHECK(at("if(t-0.3,7,3)", 0.3) == 5);
    CHECK(at("if(t-0.3,7,3)", 3 * 0.1) == 5);  // 0.30000000000000004
    CHECK(at("10*step(t)", 0) == 10);
    CHECK(at("if(t,10,2)", 0) == 10);  // as immediately after the start
    CHECK(at("10*step(t-1)", 1, 1) == 10);
    CHECK(at("step(t-1)*step(2-t)", 2) == 0.5);
    CHECK(at("abs(t-1)", 1) == 0);
    const NodeFormula law(io::Expression("l*step(t-1)+ldot", {"l", "ldot", "t"}), 2);
    const double variables[] = {4., 3., 1.};
    CHECK(law.value(variables, 0) == 5);
}
