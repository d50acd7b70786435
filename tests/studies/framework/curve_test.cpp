// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/curve.hpp"

#include "studies/framework/published.hpp"
#include "tests/support/program/program.hpp"

#include "lie/check.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// y = cos(t), with a missing value at the end
studies::Curve cosine(double h, int rows)
{
    studies::Curve curve({"t", "y", "z"});
    for (int k = 0; k < rows; ++k) curve.add({k * h, std::cos(k * h), k + 1 < rows ? -2. * k : std::nan("")});
    return curve;
}

}  // namespace

TEST_CASE("a curve gives its values, extrema and crossings by the name of the column", "[studies][curve]")
{
    const double h = 0.01, pi = 3.141592653589793;
    const studies::Curve curve = cosine(h, 1001);
    REQUIRE(curve.rows() == 1001);
    CHECK(curve.last("y") == std::cos(10.));
    CHECK(curve.column("x") == 3);
    CHECK(curve.largest("z") == 2. * 999);  // without NaN
    CHECK(curve.largest("y", 2) == Approx(1).margin(1e-4));
    CHECK(curve.first_time([&](size_t k) { return curve.at(k, "y") < 0; }) == Approx(1.58));
    CHECK(std::isnan(curve.first_time([&](size_t k) { return curve.at(k, "y") > 2; })));
    const std::vector<double> zeros = curve.zero_crossings("y");
    REQUIRE(zeros.size() == 2);
    CHECK(zeros[0] == Approx(pi / 2).margin(1e-6));
    CHECK(zeros[1] == Approx(5 * pi / 2).margin(1e-6));
    const studies::Curve::Extremum least = curve.extremum(314, "y", h);
    CHECK(least.t == Approx(pi).margin(1e-6));
    CHECK(least.value == Approx(-1).margin(1e-9));
    CHECK(std::isnan(studies::Curve({"t"}).last("t")));
}

TEST_CASE("the table of curves repeats the keys of a run and thins long curves", "[studies][curve]")
{
    studies::CurveTable table({"run", "h"}, {"t", "y", "z"});
    table.add({"a,b", 0.5}, cosine(0.5, 5), 3);
    CHECK(table.csv() ==
          "run,h,t,y,z\n\"a,b\",0.5,0,1,-0\n\"a,b\",0.5,1,0.5403023058681398,-4\n"
          "\"a,b\",0.5,2,-0.4161468365471424,\n");
}

TEST_CASE("published values are found by the numbers of rows and columns", "[studies][curve]")
{
    const Scratch in;
    write(in / "a.csv", "eta,1.0,2,x\n0.10,5,,7\n0.2,6,8,9\n");
    const studies::PublishedGrid numbers{in / "a.csv", "", {}, "rows are eta"};
    const std::vector<double> values = numbers.values({{0.1, 1}, {0.1, 2}, {0.2, 2}, {0.3, 1}, {0.2, 3}});
    CHECK(values[0] == 5);
    CHECK(std::isnan(values[1]));
    CHECK(values[2] == 8);
    CHECK(std::isnan(values[3]));
    CHECK(std::isnan(values[4]));
    CHECK_THROWS_WITH(numbers.values({{7, 1}}), Contains("a.csv: has no cell of this grid; rows are eta"));

    const studies::PublishedGrid names{in / "a.csv", "eta",
                                       [](double value) { return value == 1 ? "x" : "y"; }, "rows are eta"};
    CHECK(names.values({{0.2, 1}})[0] == 9);
    CHECK_THROWS_WITH(names.values({{0.2, 2}}), Contains("there is no column 'y'"));
}
