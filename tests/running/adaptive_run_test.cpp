// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/single_run.hpp"
#include "tests/support/adaptive_scheme.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("an adaptive scheme integrates from output row to output row", "[run][run]")
{
    const Scratch in;
    run::RunOptions options;
    options.model = "double_pendulum";
    options.end = 0.1;
    options.interval = 0.02;
    options.quiet = true;
    options.settings.rtol = 1e-6;
    run::SingleRun run(options, inner_steps, in / "out");
    const run::RunResult result = run.execute();
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

TEST_CASE("an adaptive integrator rejects --step, and without a complete state --checkpoint and --resume",
          "[run][run]")
{
    const Scratch in;
    for (const std::string& name : adaptive_schemes()) {
        const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
            check_refused(in, with({"run", "double_pendulum", "--end", "0.1", "--integrator", name}, more), 2,
                          "run: " + name + ' ' + message);
        };
        refused({"--step", "1e-3"},
                "chooses its own steps by --rtol and --atol; --step is for fixed-step schemes");
        if (!lie::scheme(name).resumes) {
            refused({"--checkpoint", "1"}, "stores past steps outside the state");
            refused({"--resume"}, "stores past steps outside the state");
        }
        refused({"--interval", "0"}, "chooses its own steps; --interval");
        CHECK(call(in, {"run", "double_pendulum", "--end", "0.1", "--integrator", name, "--output", name})
                  .code == 0);
        CHECK_THAT(call(in, {"integrators"}).out, Contains("adaptive"));
    }
}

namespace {

/// A parallelogram of three bars of 1 m and 1 kg. It lies flat, with a further degree of freedom, at about
/// 0.711 s, 1.218 s.
const char* const parallelogram = R"({"hilda_model": 1, "name": "m", "end": 1.3, "gravity": [0, -9.81, 0],
 "bodies": [
  {"name": "a", "mass": 1, "inertia": [0.08, 0.001, 0.08], "r": [0, 0.5, 0], "r_dot": [0.5, 0, 0], "omega": [0, 0, -1]},
  {"name": "b", "mass": 1, "inertia": [0.08, 0.001, 0.08], "r": [1, 0.5, 0], "r_dot": [0.5, 0, 0], "omega": [0, 0, -1]},
  {"name": "bar", "mass": 1, "inertia": [0.001, 0.08, 0.08], "r": [0.5, 1, 0], "r_dot": [1, 0, 0]}],
 "constraints": [
  {"name": "A", "type": "revolute", "body_i": "ground", "body_j": "a", "s_bar_q_j": [0, -0.5, 0], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
  {"name": "B", "type": "revolute", "body_i": "ground", "body_j": "b", "s_bar_p_i": [1, 0, 0], "s_bar_q_j": [0, -0.5, 0], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
  {"name": "C", "type": "revolute", "body_i": "a", "body_j": "bar", "s_bar_p_i": [0, 0.5, 0], "s_bar_q_j": [-0.5, 0, 0], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
  {"name": "D", "type": "revolute", "body_i": "b", "body_j": "bar", "s_bar_p_i": [0, 0.5, 0], "s_bar_q_j": [0.5, 0, 0], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}]})";

}  // namespace

TEST_CASE("an adaptive run that passes a configuration of lower rank warns once", "[run][run]")
{
    const Scratch in;
    write(in / "m.json", parallelogram);
    const auto warnings = [&](const std::string& model, const std::vector<std::string>& more) {
        const Ended ended = call(in, with({"run", model, "--force", "--output", "a"}, more));
        CAPTURE(ended.err);
        CHECK(ended.code == 0);
        std::string found;
        const auto summary = nlohmann::json::parse(read(in / "a/summary.json"));
        for (const auto& w : summary["model"]["warnings"])
            if (const std::string text = w; text.find("lose rank") != text.npos) found += text + '\n';
        return found;
    };
    for (const char* scheme : {"ida-rp-index1", "ida-rp-baumgarte"}) {
        CAPTURE(scheme);
        const std::string flat = warnings("m.json", {"--integrator", scheme});
        CHECK(std::count(flat.begin(), flat.end(), '\n') == 1);
        CHECK_THAT(flat, Contains("the constraints nearly lose rank at t = 0.7") ||
                             Contains("the constraints nearly lose rank at t = 1.2"));
        CHECK(warnings("m.json", {"--integrator", scheme, "--end", "0.6"}).empty());
        CHECK(warnings("slider_crank", {"--integrator", scheme, "--end", "1"}).empty());
        CHECK(warnings("double_pendulum", {"--integrator", scheme, "--end", "1"}).empty());
    }
}

TEST_CASE("a scheme with both forms has adaptive steps without --step", "[run][run]")
{
    const Scratch in;
    for (const std::string name : {"rA-dp-5", "rA-dop853", "rA-radau-5"}) {
        CAPTURE(name);
        const std::vector<std::string> run = {
            "run", "double_pendulum_moving", "--end", "0.5", "--integrator", name, "--force", "--output",
            name};
        CHECK(call(in, with(run, {"--rtol", "1e-8", "--interval", "0.1"})).code == 0);
        auto summary = nlohmann::json::parse(read(in / (name + "/summary.json")));
        CHECK(summary["integrator"]["rtol"] == 1e-8);
        CHECK_FALSE(summary["integrator"].contains("step"));
        CHECK(summary["counters"]["steps"] < 100);
        const auto rows = csv(in / (name + "/trajectory.csv"));
        REQUIRE(rows.size() == 6);

        CHECK(call(in, with(run, {"--step", "5e-3", "--interval", "0.1"})).code == 0);
        summary = nlohmann::json::parse(read(in / (name + "/summary.json")));
        CHECK(summary["integrator"]["step"] == 5e-3);
        CHECK(summary["counters"]["steps"] == 100);
        const auto fixed = csv(in / (name + "/trajectory.csv"));
        for (size_t k = 0; k < rows.size(); ++k)
            for (const auto& [column, value] : rows[k])
                CHECK(number(rows[k], column) == Approx(number(fixed[k], column)).margin(1e-5).epsilon(1e-5));

        const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
            check_refused(in, with(run, more), 2, message);
        };
        refused({"--step", "1e-3", "--rtol", "1e-6"},
                "run: " + name +
                    " has a fixed step with --step, and adaptive steps with --rtol; give one of them");
        refused({"--rtol", "0.2"}, "--rtol: must be a number from 1e-14");
        refused({"--atol", "9e-15"}, "--atol: must be a number from 1e-14");
        refused({"--interval", "0"}, "chooses its own steps; --interval");
        refused({"--error"}, "chooses its own steps; --error");
        check_refused(in, {"run", "double_pendulum", "--integrator", "rA-rkmk-4", "--rtol", "1e-6"}, 2,
                      "run: no selected integrator uses --rtol; it is for ida-rp, ida-rp-baumgarte, "
                      "ida-rp-index1, rA-dop853, rA-dp-5, rA-radau-5");
    }
}

TEST_CASE("an adaptive run ends at its end", "[run][run]")
{
    const Scratch in;
    for (const std::string scheme : {"rA-dop853", "rA-radau-5", "ida-rp"})
        for (const auto& [interval, rows] :
             {std::pair{"0.033", 5}, std::pair{"0.7", 2}, std::pair{"0.025", 5}}) {
            CAPTURE(scheme, interval);
            const Ended run = call(in, {"run", "double_pendulum", "--integrator", scheme, "--end", "0.1",
                                        "--interval", interval, "--force", "--output", "o"});
            CHECK(run.code == 0);
            CHECK((run.err.find("the end 0.1 s is not a multiple of --interval") != std::string::npos) ==
                  (std::string(interval) != "0.025"));
            const auto table = csv(in / "o/trajectory.csv");
            CHECK(static_cast<int>(table.size()) == rows);
            CHECK(number(table.back(), "t") == Approx(0.1).epsilon(1e-14));
        }
}

TEST_CASE("an adaptive run in two parts has the bytes of one run", "[run][run][resume]")
{
    const Scratch in;
    for (const std::string name : {"rA-dp-5", "rA-dop853", "rA-radau-5"})
        for (const std::string model : {"n_pendulum_2_spin", "slider_crank"}) {
            const std::vector<std::string> run = {
                "run",   model,     "--integrator",    name, "--rtol", "1e-7", "--interval",
                "0.013", "--quiet", "--linear-solver", "klu"};
            CAPTURE(name, model);
            CHECK(call(in, with(run, {"--end", "1.3", "--output", name + model + "1"})).code == 0);
            CHECK(call(in, with(run, {"--end", "0.39", "--output", name + model + "2"})).code == 0);
            CHECK(call(in, with(run, {"--end", "1.3", "--output", name + model + "2", "--resume"})).code ==
                  0);
            CHECK(read(in / (name + model + "1/trajectory.csv")) ==
                  read(in / (name + model + "2/trajectory.csv")));
            check_refused(
                in,
                {"run", model, "--integrator", name, "--rtol", "1e-6", "--interval", "0.013", "--end", "2.6",
                 "--linear-solver", "klu", "--output", name + model + "2", "--resume"},
                2, "it has --rtol 1e-07; this run has --rtol 1e-06");
        }
}

TEST_CASE("adaptive steps of a scheme on the group refuse contacts and loads with a history by name",
          "[run][run]")
{
    const Scratch in;
    for (const std::string model : {"bouncing_ellipsoid", "ball_in_bowl", "rolling_ball"}) {
        check_refused(
            in, {"run", model, "--integrator", "rA-dp-5", "--rtol", "1e-6"}, 3,
            "integrator rA-dp-5: adaptive steps do not support contacts; use a fixed step, got contact '");
        check_refused(in, {"run", model, "--integrator", "rA-radau-5", "--rtol", "1e-6"}, 3,
                      "integrator rA-radau-5: ");
        CHECK(call(in, {"run", model, "--integrator", "rA-dp-5", "--step", "1e-5", "--end", "1e-4", "--force",
                        "--output", "a"})
                  .code == 0);
    }
}
