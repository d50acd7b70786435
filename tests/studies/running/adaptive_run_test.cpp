// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/single_run.hpp"
#include "tests/studies/adaptive_scheme.hpp"
#include "tests/studies/csv.hpp"
#include "tests/studies/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("an adaptive scheme integrates from output row to output row", "[studies][run]")
{
    const Scratch in;
    studies::RunOptions options;
    options.model = "double_pendulum";
    options.end = 0.1;
    options.interval = 0.02;
    options.quiet = true;
    options.settings.rtol = 1e-6;
    studies::SingleRun run(options, inner_steps, in / "out");
    const studies::RunResult result = run.execute();
    CHECK(result.status == "ok");
    CHECK(result.statistics.steps == 5 * 20);  // inner steps
    const auto rows = csv(in / "out/trajectory.csv");
    REQUIRE(rows.size() == 6);
    CHECK(number(rows[3], "t") == Approx(0.06));

    const auto summary = nlohmann::json::parse(read(in / "out/summary.json"));
    CHECK(summary["integrator"]["rtol"] == 1e-6);
    CHECK(summary["integrator"]["atol"] == 1e-6);
    CHECK_FALSE(summary["integrator"].contains("step"));
    CHECK(summary["counters"]["steps"] == 100);
    std::ostringstream text;
    print(result, text);
    CHECK_THAT(text.str(), Contains("inner-steps, rtol 1e-6, atol 1e-6, end 0.1 s"));
}

TEST_CASE("an adaptive integrator rejects --step, --checkpoint and --resume", "[studies][run]")
{
    const Scratch in;
    for (const std::string& name : adaptive_schemes()) {
        const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
            check_refused(in, with({"run", "double_pendulum", "--end", "0.1", "--integrator", name}, more), 2,
                          "run: " + name + ' ' + message);
        };
        refused({"--step", "1e-3"},
                "chooses its own steps by --rtol and --atol; --step is for fixed-step schemes");
        refused({"--checkpoint", "1"}, "stores past steps outside the state");
        refused({"--resume"}, "stores past steps outside the state");
        refused({"--interval", "0"}, "chooses its own steps; --interval");
        CHECK(call(in, {"run", "double_pendulum", "--end", "0.1", "--integrator", name, "--output", name})
                  .code == 0);
        CHECK_THAT(call(in, {"integrators"}).out, Contains("adaptive"));
    }
}
