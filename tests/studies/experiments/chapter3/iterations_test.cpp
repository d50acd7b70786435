// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda::tests;

TEST_CASE("the time intervals of the iterations study are consistent with its means", "[studies][iterations]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"study", "iterations", "--problem", "double_pendulum,slider_crank", "--integrator",
                  "rA-half-1,rA-full-1", "--steps", "1e-2,5e-4", "--end", "0.4", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto runs = csv(in / "out/iterations/study.csv");
    const auto intervals = csv(in / "out/iterations/iterations.csv");
    REQUIRE(runs.size() == 8);
    for (const CsvRow& run : runs) {
        CAPTURE(run.at("problem"), run.at("integrator"), run.at("h"));
        const double h = number(run, "h");
        double before = 0, sum = 0, most = 0;
        int bins = 0;
        for (const CsvRow& bin : intervals) {
            if (bin.at("problem") != run.at("problem") || bin.at("integrator") != run.at("integrator") ||
                bin.at("h") != run.at("h"))
                continue;
            const double t = number(bin, "t");
            sum += number(bin, "mean") * std::round((t - before) / h);
            most = std::max(most, number(bin, "max"));
            before = t;
            ++bins;
        }
        CHECK(bins <= 300);
        CHECK(before == Approx(0.4));
        CHECK(number(run, "steps") == std::round(0.4 / h));
        CHECK(number(run, "iterations_per_step") == Approx(sum / number(run, "steps")));
        CHECK(number(run, "max_iterations") == most);
        CHECK(most >= number(run, "iterations_per_step"));
    }
}

TEST_CASE("the JSON output of the iterations study contains its table", "[studies][iterations]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "iterations", "--problem", "four_link", "--integrator",
                                  "rA-half-1", "--steps", "1e-2", "--end", "0.1", "--json"});
    REQUIRE(ended.code == 0);
    const auto study = nlohmann::json::parse(ended.out);
    CHECK(study["study"] == "iterations");
    CHECK(study["settings"]["tolerance"] == 1e-10);
    CHECK(study["provenance"].contains("cpu"));
    CHECK(study["runs"][0]["iterations_per_step"].get<double>() > 1);
    CHECK_FALSE(fs::exists(in / "out"));
}
