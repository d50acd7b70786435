// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("compare lists the differences of several integrators to the reference solution",
          "[studies][compare]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "compare", "--problem", "double_pendulum_moving", "--integrator",
                                  "rA-half-1,rA-half-2", "--steps", "2e-3", "--end", "0.5", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("max dr [m]"));
    const auto rows = csv(in / "out/compare/compare.csv");
    REQUIRE(rows.size() == 251);
    CHECK(number(rows.back(), "t") == Approx(0.5));
    const auto runs = csv(in / "out/compare/study.csv");
    REQUIRE(runs.size() == 2);
    for (const CsvRow& run : runs) {
        const std::string name = run.at("integrator");
        CAPTURE(name);
        double largest = 0;
        for (const CsvRow& row : rows) {
            // the observable is the height of the last bar, which is also a component of the position
            CHECK(row.at(name + ".observable") == row.at(name + ".rz"));
            largest = std::max(largest, number(row, name + ".diff_r"));
            double squared_distance = 0;
            for (const char* r : {".rx", ".ry", ".rz"})
                squared_distance +=
                    std::pow(number(row, name + r) - number(row, std::string("reference") + r), 2);
            CHECK(std::sqrt(squared_distance) <= number(row, name + ".diff_r") * (1 + 1e-9) + 1e-15);
        }
        CHECK(number(run, "max_r") == Approx(largest));
        CHECK(run.at("end_r") == rows.back().at(name + ".diff_r"));
        CHECK(run.at("end_omega") == rows.back().at(name + ".diff_omega"));
    }
    CHECK(number(runs[1], "max_r") < 0.1 * number(runs[0], "max_r"));
}

TEST_CASE("compare accepts one problem and one step only", "[studies][compare]")
{
    const Scratch in;
    const Ended problems = call(in, {"study", "compare", "--problem", "double_pendulum,four_link"});
    CHECK(problems.code == 2);
    CHECK_THAT(problems.err, Contains("takes one problem"));
    const Ended steps = call(in, {"study", "compare", "--steps", "1e-2,1e-3"});
    CHECK(steps.code == 2);
    CHECK_THAT(steps.err, Contains("takes one step"));
    CHECK_FALSE(fs::exists(in / "out/compare"));
}
