// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::tests;

TEST_CASE("the decades of the long-time study have the means and extremes of a run", "[studies][long-time]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"study", "long-time", "--problem", "heavy_top", "--integrator", "rA-rattle,rA-half-1-kick",
                  "--steps", "1e-3", "--end", "2", "--tolerance", "1e-14", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto runs = csv(in / "out/long-time/study.csv");
    const auto decades = csv(in / "out/long-time/decades.csv");
    REQUIRE(runs.size() == 2);
    REQUIRE(decades.size() == 4);  // until 0.2 s and 2 s
    for (const CsvRow& run : runs) {
        CAPTURE(run.at("integrator"));
        double energy = 0, momentum = 0;
        for (const CsvRow& decade : decades) {
            if (decade.at("integrator") != run.at("integrator")) continue;
            CHECK((number(decade, "t") == Approx(0.2) || number(decade, "t") == Approx(2)));
            CHECK(std::abs(number(decade, "energy_mean")) <= number(decade, "energy_max"));
            energy = std::max(energy, number(decade, "energy_max"));
            momentum = std::max(momentum, number(decade, "momentum_max"));
        }
        CHECK(number(run, "energy_max") == energy);
        CHECK(number(run, "momentum_max") == momentum);
        CHECK(energy > 0);
    }
    // The momentum along gravity is conserved to rounding by a variational scheme.
    CHECK(number(runs[0], "momentum_max_relative") < 1e-11);
}

TEST_CASE("the drift of the energy is that of the first to the last tenth of a run", "[studies][long-time]")
{
    const Scratch in;
    REQUIRE(call(in, {"study", "long-time", "--problem", "n_pendulum_2_spin", "--integrator",
                      "rA-half-1,rA-rattle-6", "--steps", "2e-3", "--end", "4", "--no-plot"})
                .code == 0);
    const auto runs = csv(in / "out/long-time/study.csv");
    REQUIRE(runs.size() == 2);
    // The same by hand
    REQUIRE(call(in, {"run", "n_pendulum_2_spin", "--integrator", "rA-half-1", "--step", "2e-3", "--end", "4",
                      "--interval", "2e-3", "--quiet", "--output", "run"})
                .code == 0);
    const auto rows = csv(in / "run/trajectory.csv");
    REQUIRE(rows.size() == 2001);
    double first = 0, last = 0;
    for (std::size_t n = 1; n <= 200; ++n) first += number(rows[n], "energy") / 200;
    for (std::size_t n = 1801; n <= 2000; ++n) last += number(rows[n], "energy") / 200;
    CHECK(number(runs[0], "energy_drift") == Approx(last - first).epsilon(1e-6));
    CHECK(std::abs(number(runs[1], "energy_drift")) < 1e-6 * std::abs(number(runs[0], "energy_drift")));
}

TEST_CASE("a run of the long-time study that is shorter than a decade has one row", "[studies][long-time]")
{
    const Scratch in;
    REQUIRE(call(in, {"study", "long-time", "--problem", "heavy_top", "--integrator", "rA-rattle", "--steps",
                      "1e-2", "--end", "0.05", "--no-plot"})
                .code == 0);
    const auto decades = csv(in / "out/long-time/decades.csv");
    REQUIRE(decades.size() == 1);
    CHECK(number(decades[0], "t") == Approx(0.05));
}
