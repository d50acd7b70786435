// SPDX-License-Identifier: GPL-3.0-or-later
/// Failed runs of studies, and options that a study does not use
#include "lie/integrator.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

// With a step of 0.25 s the Newton iteration of rA-full-1 diverges and that of rA-half-1 converges.
const std::vector<std::string> mixed = {"--problem",    "double_pendulum",     "--steps", "0.25,5e-3",
                                        "--integrator", "rA-full-1,rA-half-1", "--end",   "0.5",
                                        "--no-plot"};
const std::vector<std::string> all_failing = {"--problem", "double_pendulum",  "--steps",
                                              "0.1",       "--integrator",     "rA-half-1,rA-full-1",
                                              "--no-plot", "--max-iterations", "3"};

Ended call_study(const Scratch& in, const std::string& kind, const std::vector<std::string>& arguments,
                 const std::vector<std::string>& more = {})
{
    return call(in, with(with({"study", kind}, arguments), more));
}

}  // namespace

TEST_CASE("a failed run has a row in the table and the other runs continue", "[studies][member]")
{
    const std::string kind = GENERATE("energy", "iterations", "timing");
    const Scratch in;
    const Ended ended = call_study(in, kind, mixed);
    CAPTURE(kind, ended.out, ended.err);
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("newton_diverged") && Contains("\nfailed:\n"));
    const auto rows = csv(in / "out" / kind / "study.csv");
    CHECK(rows.size() == 4);
    for (const CsvRow& row : rows) {
        CAPTURE(row.at("integrator"));
        const bool fails = row.at("h") == "0.25" && row.at("integrator") == "rA-full-1";
        CHECK(row.at("status") == (fails ? "newton_diverged" : "ok"));
    }
}

TEST_CASE("a study exits with 4 if all of its runs fail", "[studies][member]")
{
    const std::string kind =
        GENERATE("convergence", "compare", "energy", "iterations", "timing", "work-precision");
    const Scratch in;
    const Ended ended = call_study(in, kind, all_failing);
    CAPTURE(kind, ended.err);
    CHECK(ended.code == 4);
    CHECK_THAT(ended.err, StartsWith("hilda: error[newton_diverged]: study " + kind + ": all 2 runs failed"));
    const auto rows = csv(in / "out" / kind / "study.csv");
    CHECK(rows.size() == 2);
    for (const CsvRow& row : rows) CHECK(row.at("status") == "newton_diverged");
}

TEST_CASE("convergence and work-precision write the rows of failed runs", "[studies][member]")
{
    const std::string kind = GENERATE("convergence", "work-precision");
    const Scratch in;
    std::vector<std::string> arguments = {"--problem",    "double_pendulum", "--steps",  "0.1,2e-2",
                                          "--integrator", "rA-full-1",       "--no-plot"};
    if (kind == "work-precision") arguments.insert(arguments.end(), {"--repeats", "1"});
    const Ended ended = call_study(in, kind, arguments);
    CAPTURE(kind, ended.out, ended.err);
    CHECK(ended.code == 0);
    const auto rows = csv(in / "out" / kind / "study.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("status") == "newton_diverged");
    CHECK(std::isnan(number(rows[0], "r")));
    CHECK(rows[1].at("status") == "ok");
    CHECK(number(rows[1], "r") > 0);
}

TEST_CASE("an option that a study does not use is rejected", "[studies][member]")
{
    const Scratch in;
    const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
        check_refused(in, with({"study"}, more), 2, message);
    };
    refused({"energy", "--bars", "4"}, "study energy: --bars is for scaling");
    refused({"energy", "--rtols", "1e-4"}, "--rtols is for stiffness, work-precision");
    refused({"convergence", "--repeats", "3"}, "--repeats is for scaling, stiffness, timing, work-precision");
    refused({"timing", "--reference", "rA-half-2"}, "--reference is for compare, convergence");
    refused({"energy", "--against", "a.csv"}, "study energy: --against is for ");
    refused({"energy", "--preset", "balanced"}, "study energy: --preset is for ");
    refused({"energy", "--preset", "thesis"}, "--preset: must be balanced or dissertation");
    refused({"energy", "--grid", "fine"}, "study energy: --grid is for ");
    refused({"timings"}, "unknown study 'timings'; did you mean 'timing'?");
    refused({"scaling", "--bars", "4,0"}, "--bars: N must be a whole number from 1 to 100000, got '0'");
    refused({"scaling", "--bars", "-1"}, "--bars");
    refused({"scaling", "--bars", "2.5"}, "got '2.5'");
    refused({"scaling", "--bars", "100001"}, "got '100001'");
    refused({"scaling", "--bars", "2,2"}, "each N once");
    refused({"scaling", "--problem", "four_link"}, "N-bar pendulum");
    refused({"scaling", "--seed", "-1"}, "--seed: must be a whole number");
    refused({"timing", "--repeats", "0"}, "--repeats: must be a whole number, at least 1");
    refused({"work-precision", "--rtols", "1e-4,0"}, "--rtols: must be a number from 1e-14");
    refused({"work-precision", "--rtols", "9e-15"}, "got '9e-15'");
    refused({"work-precision", "--rtols", "1e-4,1e-4"}, "each tolerance once");
    refused({"work-precision", "--integrator", "rA-half-3"}, "unknown integrator 'rA-half-3'; did you mean");
    refused({"energy", "--steps", "7e-3"}, "must divide the end of double_pendulum, 30 s, got 0.007");
    CHECK_FALSE(fs::exists(in / "out/scaling"));
}

TEST_CASE("a run that a scheme cannot do is refused in its row, and the others are computed",
          "[studies][run]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"study", "compare", "--problem", "rolling_ball", "--integrator", "ida-rp,rA-half-1-kick",
                  "--steps", "1e-4", "--end", "0.01", "--no-plot", "--output", "a"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("ida-rp on rolling_ball") && Contains("refused"));
    CHECK(fs::exists(in / "a/study.json"));
}
