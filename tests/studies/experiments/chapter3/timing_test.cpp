// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model_file.hpp"
#include "studies/framework/stopwatch.hpp"
#include "studies/framework/work_needed.hpp"
#include "studies/problems/n_pendulum.hpp"
#include "tests/support/adaptive_scheme.hpp"
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using namespace hilda::tests;
using namespace hilda::studies;
using Catch::Matchers::Contains;

TEST_CASE("medians, ratios and exponents agree with closed forms", "[studies][timing]")
{
    CHECK(spread({3, 1, 2}).median == 2);
    CHECK(spread({4, 1, 2, 3}).median == 2.5);
    CHECK(spread({4, 1, 2, 3}).least == 1);
    CHECK(spread({4, 1, 2, 3}).most == 4);
    CHECK(spread({7}).median == 7);
    CHECK(std::isnan(spread({}).median));

    TimedRun a, b;
    a.repeat = {1, 20, 3}, b.repeat = {2, 40, 4};  // the second repeat is slow for both
    CHECK(ratio(a, b) == 0.5);
    b.repeat.clear();
    CHECK(std::isnan(ratio(a, b)));
    a.statistics.steps = 1000;
    CHECK(a.microseconds().median == Approx(3000));

    std::vector<double> N, t;
    for (const double n : {64., 128., 256., 1024.}) N.push_back(n), t.push_back(3 * std::pow(n, 1.2));
    CHECK(exponent(N, t).fitted == Approx(1.2));
    CHECK(exponent(N, t).largest_local == Approx(1.2));
    t.back() *= 2;
    CHECK(exponent(N, t).largest_local == Approx(1.2 + 0.5));
    CHECK(std::isnan(exponent({64}, {1}).fitted));
}

TEST_CASE("the work for an accuracy is interpolated on logarithmic axes", "[studies][timing]")
{
    // e = 1 / t^2: 1e-3 is reached at sqrt(1000)
    const WorkNeeded w = work_needed({1e-2, 1e-4}, {10, 100}, 1e-3);
    CHECK(w.seconds == Approx(std::sqrt(1000.)));
    CHECK_FALSE(w.at_most);
    CHECK(std::isnan(work_needed({1e-1, 1e-2}, {1, 10}, 1e-3).seconds));
    CHECK(std::isnan(work_needed({}, {}, 1e-3).seconds));
    CHECK(work_needed({1e-5, 1e-6}, {1, 10}, 1e-3).seconds == 1);
    CHECK(work_needed({1e-5, 1e-6}, {1, 10}, 1e-3).at_most);
    CHECK(work_needed({std::nan(""), 1e-6}, {std::nan(""), 10}, 1e-3).seconds == 10);
}

TEST_CASE("the timing study reports times, ratios and the machine", "[studies][timing]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "timing", "--problem", "double_pendulum", "--integrator",
                                  "rA-half-1,rA-full-1", "--steps", "1e-2", "--end", "0.2", "--repeats", "2",
                                  "--no-plot", "--expect", "ratio_to_full=1+-0.99"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("half-implicit over fully implicit"));
    const auto rows = csv(in / "out/timing/study.csv");
    REQUIRE(rows.size() == 2);
    for (const CsvRow& row : rows) {
        CHECK(number(row, "us_per_step_min") > 0);
        CHECK(number(row, "us_per_step_min") <= number(row, "us_per_step"));
        CHECK(number(row, "us_per_step") <= number(row, "us_per_step_max"));
        CHECK(number(row, "steps") == 20);
    }
    CHECK(number(rows[1], "ratio_to_full") == 1);
    const auto record = nlohmann::json::parse(read(in / "out/timing/study.json"));
    CHECK(record["repeats"] == 2);
    CHECK(record["provenance"]["threads"] == 1);
    CHECK_FALSE(record["provenance"]["cpu"].get<std::string>().empty());
}

TEST_CASE("the same seed gives the same initial spins and another seed gives others", "[studies][scaling]")
{
    CHECK(spins(4, 7) == spins(4, 7));
    CHECK(spins(4, 7) != spins(4, 8));
    const std::vector<double> longer = spins(1000, 7);
    CHECK(std::equal(longer.begin(), longer.begin() + 4, spins(4, 7).begin()));
    double mean = 0;
    for (const double w : longer) {
        CHECK(std::abs(w) <= 10);
        mean += w / 1000;
    }
    CHECK(std::abs(mean) < 4 * 10 / std::sqrt(3. * 1000));
    // The standard defines std::mt19937_64: the first number with seed 5489 is 14514284786278117030.
    CHECK(spins(1, 5489)[0] ==
          Approx(20 * (14514284786278117030. / 18446744073709551616.) - 10).epsilon(1e-12));

    // The spins are consistent initial velocities: the projection does not change them.
    dae::Description d = dae::read_model(spinning_n_pendulum(3, 7).model, "chain");
    const dae::StartReport start = dae::start(d);
    CHECK(start.velocity_residual < 1e-14);
    for (int b = 0; b < 3; ++b) CHECK(d.x.body[b].omega_bar.x() == Approx(spins(3, 7)[b]));
}

TEST_CASE("the scaling study runs for each number of bars", "[studies][scaling]")
{
    const Scratch in;
    const auto study = [&](const std::string& seed) {
        const Ended ended =
            call(in, {"study", "scaling", "--bars", "2,1,8", "--integrator", "rA-half-1,rA-full-1", "--end",
                      "5e-3", "--repeats", "1", "--seed", seed, "--output", seed, "--force", "--no-plot"});
        CAPTURE(ended.err);
        REQUIRE(ended.code == 0);
        CHECK_THAT(ended.out, Contains("seed " + seed) && Contains("exponent, N >= 64"));
        CHECK(nlohmann::json::parse(read(in / seed / "study.json"))["seed"] == std::stoi(seed));
        return csv(in / (seed + "/study.csv"));
    };
    const auto rows = study("3"), again = study("3");
    REQUIRE(rows.size() == 6);
    CHECK(rows[0].at("bars") == "1");
    CHECK(rows[5].at("bars") == "8");
    for (size_t k = 0; k < rows.size(); ++k) {
        CHECK(rows[k].at("status") == "ok");
        CHECK(rows[k].at("iterations_per_step") == again[k].at("iterations_per_step"));
        CHECK(number(rows[k], "us_per_step") > 0);
        CHECK(number(rows[k], "start_seconds") > 0);
    }
    CHECK(number(rows[4], "us_per_step") > 3 * number(rows[0], "us_per_step"));
}

TEST_CASE("the work-precision study reports errors and CPU times", "[studies][work precision]")
{
    const Scratch in;
    std::string integrators = "rA-half-1,rA-half-2";
    for (const std::string& name : adaptive_schemes()) integrators += ',' + name;
    std::vector<std::string> arguments = {
        "study",     "work-precision", "--problem", "double_pendulum", "--end", "0.3",      "--steps",
        "1e-2,5e-3", "--integrator",   integrators, "--repeats",       "1",     "--no-plot"};
    if (!adaptive_schemes().empty()) arguments.insert(arguments.end(), {"--rtols", "1e-4,1e-6"});
    const Ended ended = call(in, arguments);
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("fastest integrator for an rms error of 1e-03 m: rA-half-2"));
    const auto rows = csv(in / "out/work-precision/study.csv");
    REQUIRE(rows.size() == 4 + 2 * adaptive_schemes().size());
    for (size_t k = 0; k < rows.size(); k += 2) {
        CHECK(number(rows[k], "r") > number(rows[k + 1], "r"));
        CHECK(number(rows[k], "cpu_seconds") > 0);
        CHECK(rows[k].at("h").empty() != rows[k].at("rtol").empty());
    }
}
