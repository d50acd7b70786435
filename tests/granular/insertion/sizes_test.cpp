// SPDX-License-Identifier: GPL-3.0-or-later
// Size distributions: moments and quantiles against closed forms, shares of number and of mass, and refusals.
#include "granular/insertion/sizes.hpp"
#include "granular/case/particles/fill.hpp"
#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <tuple>

using namespace hilda;
using granular::ObjectReader;
using granular::Share;
using granular::Sizes;

namespace {

Sizes sizes(const std::string& members)
{
    const io::JsonSource source("{" + members + "}", "file");
    return granular::read_sizes(ObjectReader(source, source.root, ""));
}

std::string refusal_of_sizes(const std::string& members)
{
    try {
        sizes(members);
    } catch (const io::InvalidInput& e) {
        return e.what();
    }
    return "nothing";
}

/// Mean of R^p by number, by the midpoint rule over the quantiles
double moment(const Sizes& s, int p)
{
    constexpr int n = 400000;
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += std::pow(s.quantile((k + 0.5) / n), p);
    return sum / n;
}

/// Share of the mass of particles below a radius
double mass_below(const Sizes& s, double R)
{
    constexpr int n = 400000;
    double low = 0, all = 0;
    for (int k = 0; k < n; ++k) {
        const double r = s.quantile((k + 0.5) / n), cube = r * r * r;
        all += cube, low += r < R ? cube : 0;
    }
    return low / all;
}

/// The radius below which half of the mass is
double mass_median(const Sizes& s)
{
    double low = s.least(), high = s.largest();
    for (int k = 0; k < 30; ++k) (mass_below(s, (low + high) / 2) < 0.5 ? low : high) = (low + high) / 2;
    return low;
}

constexpr double a = 5e-4, b = 2e-3;

}  // namespace

TEST_CASE("uniform sizes have the moments of their density by number and by mass", "[granular][sizes]")
{
    const std::string limits = R"("type": "uniform", "least_radius": 5e-4, "largest_radius": 2e-3)";
    const Sizes number = sizes(limits), mass = sizes(limits + R"(, "by": "mass")");
    for (const int p : {1, 2, 3, 6})
        CHECK(moment(number, p) ==
              Approx((std::pow(b, p + 1) - std::pow(a, p + 1)) / ((p + 1) * (b - a))).epsilon(1e-8));
    // f_n = c/R³: <R^p> = c ∫ R^(p-3) dR
    const double c = 2 / (1 / (a * a) - 1 / (b * b));
    CHECK(moment(mass, 1) == Approx(c * (1 / a - 1 / b)).epsilon(1e-8));
    CHECK(moment(mass, 2) == Approx(c * std::log(b / a)).epsilon(1e-8));
    CHECK(moment(mass, 3) == Approx(c * (b - a)).epsilon(1e-8));
    CHECK(number.mean_cube() == Approx(moment(number, 3)).epsilon(1e-8));
    CHECK(mass.mean_cube() == Approx(moment(mass, 3)).epsilon(1e-8));
    for (const double share : {0.1, 0.5, 0.8})
        CHECK(mass_below(mass, a + share * (b - a)) == Approx(share).margin(1e-5));
}

TEST_CASE("normal sizes are those of the truncated normal distribution", "[granular][sizes]")
{
    const double mean = 1e-3, s = 2e-4;
    const std::string members = R"("type": "normal", "mean": 1e-3, "deviation": 2e-4)";
    const auto density = [](double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); };
    const auto below = [](double z) { return std::erfc(-z / std::numbers::sqrt2) / 2; };
    for (const auto& [more, low, high] :
         {std::tuple{"", mean - 3 * s, mean + 3 * s},
          {R"(, "least_radius": 9e-4)", 9e-4, mean + 3 * s},
          {R"(, "least_radius": 1.1e-3, "largest_radius": 1.3e-3)", 1.1e-3, 1.3e-3}}) {
        const Sizes now = sizes(members + more);
        const double l = (low - mean) / s, h = (high - mean) / s, Z = below(h) - below(l),
                     first = mean + s * (density(l) - density(h)) / Z,
                     second = s * s *
                              (1 + (l * density(l) - h * density(h)) / Z -
                               std::pow((density(l) - density(h)) / Z, 2));
        CHECK(now.least() == Approx(low).epsilon(1e-12));
        CHECK(now.largest() == Approx(high).epsilon(1e-12));
        CHECK(moment(now, 1) == Approx(first).epsilon(1e-7));
        CHECK(moment(now, 2) - first * first == Approx(second).epsilon(1e-4));
        CHECK(now.mean_cube() == Approx(moment(now, 3)).epsilon(1e-7));
        for (const double u : {0.05, 0.5, 0.9})
            CHECK(below((now.quantile(u) - mean) / s) == Approx(below(l) + u * Z).margin(1e-5));
    }
    const Sizes by_mass = sizes(members + R"(, "by": "mass")");
    CHECK(mass_median(by_mass) == Approx(mean).epsilon(1e-4));
}

TEST_CASE("a lognormal distribution by number has the mass median exp(3 s²) times larger, and conversely",
          "[granular][sizes]")
{
    const double s = GENERATE(0.05, 0.2, 0.5), median = 1e-3;
    // cut off so far out that the closed forms without limits hold: the cube of the radius shifts by 3 s²
    const auto limits = [&](double shift) {
        const auto at = [&](double z) { return io::shortest(median * std::exp(s * z + shift)); };
        return R"("type": "lognormal", "median": 1e-3, "deviation": )" + io::shortest(s) +
               R"(, "least_radius": )" + at(-7) + R"(, "largest_radius": )" + at(7);
    };
    const double factor = std::exp(3 * s * s);
    const Sizes number = sizes(limits(1.5 * s * s)), mass = sizes(limits(-1.5 * s * s) + R"(, "by": "mass")");
    INFO("deviation " << s);
    CHECK(number.quantile(0.5) == Approx(median).epsilon(1e-5));
    CHECK(mass_median(number) == Approx(median * factor).epsilon(2e-4));
    CHECK(mass_median(mass) == Approx(median).epsilon(2e-4));
    CHECK(mass.quantile(0.5) == Approx(median / factor).epsilon(1e-4));
    for (const int p : {1, 2, 3})
        CHECK(moment(number, p) == Approx(std::pow(median, p) * std::exp(p * p * s * s / 2)).epsilon(2e-4));
    CHECK(number.mean_cube() == Approx(std::pow(median, 3) * std::exp(4.5 * s * s)).epsilon(2e-4));
    CHECK(mass.mean_cube() == Approx(std::pow(median / factor, 3) * std::exp(4.5 * s * s)).epsilon(2e-4));
}

TEST_CASE("classes and sieve curves have the given shares of the number or the mass", "[granular][sizes]")
{
    const std::string classes = R"("type": "table", "radii": [5e-4, 1e-3, 2e-3], "fractions": [1, 1, 2])";
    const Sizes number = sizes(classes), mass = sizes(classes + R"(, "by": "mass")");
    CHECK(number.quantile(0.2) == 5e-4);
    CHECK(number.quantile(0.3) == 1e-3);
    CHECK(number.quantile(0.9) == 2e-3);
    // numbers in proportion to the fraction over the cube of the radius: 8, 1 and 1/4
    for (const auto& [share, R] : {std::pair{8 / 9.25, 5e-4}, {9 / 9.25, 1e-3}, {1., 2e-3}}) {
        CHECK(mass.quantile(share - 1e-9) == R);
        if (share < 1) CHECK(mass.quantile(share + 1e-9) > R);
    }
    CHECK(mass.mean_cube() == Approx((8 * 1.25e-10 + 1e-9 + 0.25 * 8e-9) / 9.25));
    CHECK(mass_below(mass, 1.5e-3) == Approx(0.5).margin(1e-5));

    const std::string curve = R"("type": "table", "radii": [5e-4, 1e-3, 2e-3], "passing": [0, 0.3, 1])";
    const Sizes sieved = sizes(curve + R"(, "by": "mass")");
    CHECK(sizes(curve).quantile(0.15) == Approx(7.5e-4));
    CHECK(sizes(curve).quantile(0.65) == Approx(1.5e-3));
    CHECK(mass_below(sieved, 1e-3) == Approx(0.3).margin(1e-5));
    CHECK(mass_below(sieved, 1.5e-3) == Approx(0.65).margin(1e-5));
    // one piece is a uniform distribution
    const Sizes one = sizes(R"("type": "table", "radii": [5e-4, 2e-3], "passing": [0, 1], "by": "mass")"),
                uniform =
                    sizes(R"("type": "uniform", "least_radius": 5e-4, "largest_radius": 2e-3, "by": "mass")");
    for (const double u : {0., 0.3, 0.999}) CHECK(one.quantile(u) == uniform.quantile(u));
}

TEST_CASE("the seed determines the sizes of a fill", "[granular][sizes]")
{
    const auto fill = [](int seed) {
        const io::JsonSource source(
            R"({"type": "poisson", "low": [0, 0, 0], "high": [0.02, 0.02, 0.02], "seed": )" +
                std::to_string(seed) +
                R"(, "sizes": {"type": "lognormal", "median": 5e-4, "deviation": 0.2, "by": "mass"}})",
            "file");
        ObjectReader o(source, source.root, "");
        auto all = granular::fill(granular::read_fill(o));
        o.finish();
        return all;
    };
    const auto one = fill(3), same = fill(3), other = fill(4);
    REQUIRE(one.size() == same.size());
    double cube = 0, most = 0;
    for (std::size_t k = 0; k < one.size(); ++k) {
        REQUIRE(one[k].r == same[k].r);
        REQUIRE(one[k].radius == same[k].radius);
        cube += std::pow(one[k].radius, 3) / static_cast<double>(one.size());
        most = std::max(most, one[k].radius);
    }
    CHECK(one[0].radius != other[0].radius);
    CHECK(one.size() > 500);
    CHECK(cube == Approx(std::pow(5e-4, 3) * std::exp((-9 + 4.5) * 0.04)).epsilon(0.1));
    CHECK(most <= 5e-4 * std::exp(0.6) * (1 + 1e-9));
}

TEST_CASE("wrong size distributions are refused with their place", "[granular][sizes]")
{
    const std::pair<const char*, const char*> wrong[] = {
        {R"("type": "uniform", "least_radius": 2e-3, "largest_radius": 1e-3)",
         "(/least_radius): least_radius must not be above largest_radius, 0.001, got 0.002"},
        {R"("type": "uniform", "largest_radius": 1e-3)", "least_radius"},
        {R"("type": "gauss")", "type"},
        {R"("type": "normal", "mean": 1e-3, "deviation": 0)",
         "(/deviation): deviation must be positive, got 0"},
        {R"("type": "normal", "mean": 1e-3, "deviation": 1e-5, "least_radius": 1.1e-3)",
         "(/least_radius): least_radius must not be above largest_radius, 0.00103, got 0.0011"},
        {R"("type": "normal", "mean": 1e-3, "deviation": 1e-5, "least_radius": 1.1e-3, "largest_radius": 2e-3)",
         "(/deviation): the limits must contain at least 1e-3 of the distribution, 0.0011 to 0.002, got 7"},
        {R"("type": "lognormal", "median": 1e-3, "deviation": 4)", "deviation must be at most 3, got 4"},
        {R"("type": "lognormal", "median": 1e-3, "deviation": 0.1, "by": "volume")", "(/by)"},
        {R"("type": "table", "radii": [1e-3])", "a table must have either fractions or passing, got none"},
        {R"("type": "table", "radii": [1e-3], "fractions": [1], "passing": [1])",
         "a table must have either fractions or passing, got both"},
        {R"("type": "table", "radii": [], "fractions": [])", "radii must have a number at least, got 0"},
        {R"("type": "table", "radii": [1e-3, 1e-3], "fractions": [1, 1])",
         "(/radii/1): radii must be positive and ascending, got 0.001"},
        {R"("type": "table", "radii": [1e-3], "fractions": [1, 2])",
         "(/fractions): fractions must have as many numbers as radii, 1, got 2"},
        {R"("type": "table", "radii": [1e-3], "fractions": [-1])",
         "(/fractions/0): fractions must not be negative, got -1"},
        {R"("type": "table", "radii": [1e-3], "fractions": [0])",
         "fractions must have a positive sum, got 0"},
        {R"("type": "table", "radii": [1e-3, 2e-3], "passing": [0, 0.9])",
         "(/passing/1): passing must be 1 at the largest radius, got 0.9"},
        {R"("type": "table", "radii": [1e-3, 2e-3], "passing": [0.1, 1])",
         "(/passing/0): passing must be 0 at the smallest radius, got 0.1"},
        {R"("type": "table", "radii": [1e-3, 2e-3, 3e-3], "passing": [0, 2, 1])",
         "(/passing/2): passing must not decrease, got 1"},
        {R"("type": "uniform", "least_radius": 1e-3, "largest_radius": 1e-3, "mean": 1)", "mean"}};
    for (const auto& [members, message] : wrong) {
        INFO(members);
        CHECK_THAT(refusal_of_sizes(members), Catch::Contains(message));
    }
    CHECK(refusal_of_sizes(R"("type": "uniform", "least_radius": 1e-3, "largest_radius": 1e-3)") ==
          "nothing");
}
