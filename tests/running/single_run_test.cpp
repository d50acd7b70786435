// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/schemes.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using nlohmann::ordered_json;

namespace {

ordered_json summary_in(const fs::path& directory)
{
    return ordered_json::parse(read(directory / "summary.json"));
}

std::vector<std::string> lines(const fs::path& file)
{
    std::vector<std::string> all;
    std::istringstream in(read(file));
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
}

}  // namespace

TEST_CASE("a run writes the documented files and columns", "[run][run]")
{
    const Scratch in;
    write(in / "bar.json", pendulum());
    const Ended ended =
        call(in, {"run", "bar.json", "--end", "0.1", "--interval", "0.01", "--reactions", "--log-steps"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK(ended.err.empty());
    CHECK_THAT(ended.out, Contains("pendulum") && Contains("energy"));

    const std::vector<std::string> rows = lines(in / "out/bar/trajectory.csv");
    REQUIRE(rows.size() == 12);
    CHECK(rows[0] ==
          "t,bar.rx,bar.ry,bar.rz,bar.A11,bar.A12,bar.A13,bar.A21,bar.A22,bar.A23,bar.A31,bar.A32,bar.A33,"
          "bar.vx,bar.vy,"
          "bar.vz,bar.wx,bar.wy,bar.wz,bar.ax,bar.ay,bar.az,bar.alx,bar.aly,bar.alz,energy,constraint_norm,"
          "bar.Fx,bar.Fy,bar.Fz,bar.Tx,bar.Ty,bar.Tz,hinge.lambda1,hinge.lambda2,hinge.lambda3,hinge.lambda4,"
          "hinge.lambda5");
    CHECK_THAT(rows[1], StartsWith("0,0,1,0,1,0,0,0,1,0,0,0,1,0,0,0,0,0,0,"));
    CHECK_THAT(rows[2], StartsWith("0.01,"));
    CHECK_THAT(rows[11], StartsWith("0.1,"));

    const std::vector<std::string> steps = lines(in / "out/bar/steps.csv");
    REQUIRE(steps.size() == 101);
    CHECK(steps[0] == "t,h,newton_iterations,correction,constraint_norm,energy,factorizations,wall_ns");
    CHECK_THAT(steps[1], StartsWith("0.001,0.001,"));
    CHECK_THAT(steps[100], StartsWith("0.1,0.001,"));

    const ordered_json summary = summary_in(in / "out/bar");
    CHECK(summary["status"] == "ok");
    CHECK(summary["exit_code"] == 0);
    CHECK(summary["model"]["degrees_of_freedom"] == 1);
    CHECK(summary["counters"]["steps"] == 100);
    CHECK(summary["counters"]["newton_iterations"] >= 100);
    CHECK(summary["counters"]["rows"] == 11);
    CHECK(summary["invariants"]["constraint_norm"] < 1e-9);
    CHECK(summary["invariants"]["orthogonality"] < 1e-12);
    for (const char* key : {"version", "git", "flags", "libraries", "command_line", "cpu", "threads"})
        CHECK(summary["provenance"].contains(key));
    CHECK(ordered_json::parse(read(in / "out/bar/model.json"))["name"] == "pendulum");
    CHECK_FALSE(fs::exists(in / "out/bar/checkpoint"));
}

TEST_CASE("two identical runs write identical files, except for timing and provenance", "[run][run]")
{
    const Scratch in;
    for (const char* directory : {"a", "b"})
        REQUIRE(
            call(in, {"run", "slider_crank", "--end", "0.5", "--reactions", "--quiet", "--output", directory})
                .code == 0);
    for (const char* file : {"trajectory.csv", "model.json"})
        CHECK(read(in / "a" / file) == read(in / "b" / file));
    ordered_json a = summary_in(in / "a"), b = summary_in(in / "b");
    for (ordered_json* s : {&a, &b}) s->erase("timing"), s->erase("provenance");
    CHECK(a == b);
}

TEST_CASE("several integrators run in sequence, each in a subdirectory", "[run][run]")
{
    const Scratch in;
    const Ended ended =
        call(in, {"run", "double_pendulum", "--integrator", "rA-half-1,rA-half-2", "--end", "0.1", "--json"});
    REQUIRE(ended.code == 0);
    const ordered_json all = ordered_json::parse(ended.out);
    CHECK(all["runs"].size() == 2);
    CHECK(summary_in(in / "out/double_pendulum/rA-half-2")["integrator"]["name"] == "rA-half-2");
    CHECK(fs::exists(in / "out/double_pendulum/rA-half-1/trajectory.csv"));
}

TEST_CASE("a directory that is not empty is rejected without --force", "[run][run]")
{
    const Scratch in;
    fs::create_directory(in / "a");
    write(in / "a/notes.txt", "mine");
    const Ended refused = call(in, {"run", "double_pendulum", "--end", "0.1", "--output", "a"});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, StartsWith("hilda: error: a: is not empty"));
    CHECK_FALSE(fs::exists(in / "a/trajectory.csv"));
    CHECK(call(in, {"run", "double_pendulum", "--end", "0.1", "--output", "a", "--force"}).code == 0);
    CHECK(read(in / "a/notes.txt") == "mine");
    CHECK(call(in, {"run", "double_pendulum", "--end", "0.1", "--output", "a", "--resume"}).code == 0);
}

TEST_CASE("an invalid model exits with 3 and writes nothing", "[run][run]")
{
    const Scratch in;
    write(in / "bad.json", R"({"hilda_model": 1, "name": "bad", "bodies": [{"name": "b", "mass": -1}]})");
    for (const char* command : {"run", "check"}) {
        const Ended ended = call(in, {command, "bad.json"});
        CAPTURE(ended.err);
        CHECK(ended.code == 3);
        CHECK_THAT(ended.err, StartsWith("hilda: error: bad.json:"));
    }
    CHECK_FALSE(fs::exists(in / "out"));
}

TEST_CASE("a change by --set is applied and recorded", "[run][run]")
{
    const Scratch in;
    write(in / "bar.json", pendulum());
    REQUIRE(
        call(in, {"run", "bar.json", "--end", "0.1", "--output", "a", "--set", "/bodies/0/mass=5"}).code ==
        0);
    CHECK(summary_in(in / "a")["model"]["set"][0] == "/bodies/0/mass=5");
    CHECK(ordered_json::parse(read(in / "a/model.json"))["bodies"][0]["mass"] == 5);
    CHECK(call(in, {"run", "bar.json", "--set", "/bodies/0/mas=5"}).code == 3);
}

TEST_CASE("a load that becomes NaN ends the run with exit code 4 and the rows before it are written",
          "[run][run]")
{
    const Scratch in;
    write(in / "bar.json", pendulum("", R"json({"type": "force", "body": "bar", "point_bar": [0, 0, 0],
        "frame": "global", "name": "push", "components": ["sqrt(0.5 - t)", 0, 0]})json"));
    const Ended ended =
        call(in, {"run", "bar.json", "--step", "1e-2", "--interval", "1e-2", "--output", "a"});
    CAPTURE(ended.err);
    CHECK(ended.code == 4);
    CHECK_THAT(ended.err, StartsWith("hilda: error[nonfinite]: t=0.5") &&
                              Contains("(rA-half-1-momentum, h=0.01)") && Contains("'bar'"));
    const std::vector<std::string> rows = lines(in / "a/trajectory.csv");
    CHECK(rows.size() >= 52);
    CHECK(rows.size() <= 54);
    CHECK_THAT(rows[50], StartsWith("0.49,"));
    CHECK(summary_in(in / "a")["status"] == "nonfinite");
    CHECK(summary_in(in / "a")["exit_code"] == 4);
}

TEST_CASE("a load that overflows ends the run with the name of the body, and no infinite value is written",
          "[run][run]")
{
    const Scratch in;
    const auto model = [&](const std::string& type, const std::string& load) {
        write(in / "spin.json",
              R"json({"hilda_model": 1, "name": "spin", "gravity": [0, 0, 0], "end": 0.02, "bodies": [
            {"name": "still", "mass": 1, "inertia": [1, 1, 1], "r": [5, 0, 0], "euler_angles": {"sequence": "zxz", "angles": [0.1, 1, 0.1]}},
            {"name": "spinner", "mass": 1, "inertia": [1, 2, 3], "r": [0, 0, 0], "euler_angles": {"sequence": "zxz", "angles": [0.1, 1, 0.1]}}],
            "forces": [{"name": "push", "type": ")json" +
                  type + R"json(", "body": "spinner", "frame": "global", "components": [0, 0, )json" + load +
                  "]}]}");
    };
    const std::pair<const char*, const char*> loads[] = {{"force", "\"exp(1e5*(t-0.01))\""},
                                                         {"force", "1e300"},
                                                         {"torque", "1e200"},
                                                         {"torque", "\"exp(1e5*(t-0.01))\""}};
    for (const auto& [type, load] : loads) {
        for (const hilda::lie::Scheme& scheme : hilda::lie::schemes()) {
            // An adaptive scheme follows the growth with many steps: a faster one.
            std::string formula = load;
            const bool adaptive = scheme.with_adaptive_steps().adaptive;
            if (const size_t rate = formula.find("1e5"); adaptive && rate != std::string::npos)
                formula.replace(rate, 3, "1e7");
            model(type, formula);
            const Ended ended = call(in, {"run", "spin.json", "--integrator", scheme.name, "--interval",
                                          "1e-3", "--quiet", "--output", "a", "--force"});
            CAPTURE(type, load, scheme.name, ended.err);
            CHECK(ended.code == 4);
            if (ended.err.find("[nonfinite]") != std::string::npos ||
                ended.err.find("[step_too_large]") != std::string::npos)
                CHECK_THAT(ended.err, Contains("spinner"));
            const std::string rows = read(in / "a/trajectory.csv");
            const std::string values = rows.substr(rows.find('\n'));
            CHECK(values.find("inf") == std::string::npos);
            CHECK(values.find("nan") == std::string::npos);
            CHECK(values.size() > 20);
        }
    }
}

TEST_CASE("initial velocities whose kinetic energy overflows are refused with the name of the body",
          "[run][run]")
{
    const Scratch in;
    for (const char* velocity : {R"("r_dot": [1e200, 0, 0])", R"("omega": [0, 0, 1e200])"}) {
        write(in / "fast.json",
              std::string(R"({"hilda_model": 1, "name": "fast", "end": 1, "bodies": [{"name": "ball",
            "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0], )") +
                  velocity + "}]}");
        const Ended ended = call(in, {"run", "fast.json", "--output", "a"});
        CAPTURE(ended.err);
        CHECK(ended.code == 3);
        CHECK_THAT(
            ended.err,
            Contains("the initial velocity of body 'ball' is too large: its kinetic energy overflows"));
        CHECK_FALSE(fs::exists(in / "a"));
    }
}

TEST_CASE("a Newton iteration that does not converge is reported with its step and constraint", "[run][run]")
{
    const Scratch in;
    const Ended ended = call(in, {"run", "double_pendulum", "--integrator", "rA-half-1", "--step", "0.5",
                                  "--output", "a", "--json"});
    CAPTURE(ended.err);
    CHECK(ended.code == 4);
    CHECK_THAT(ended.err,
               StartsWith("hilda: error[newton_diverged]: t=0.50 step 1 (rA-half-1, h=0.5): correction ") &&
                   Contains(" after 30 iterations, on average ") &&
                   Contains(" times the one before: no convergence\n  largest: constraint '") &&
                   Contains("reciprocal condition"));
    CHECK(ordered_json::parse(ended.out)["status"] == "newton_diverged");
    CHECK(lines(in / "a/trajectory.csv").size() == 2);
}

TEST_CASE("a DP1 driver whose vectors become parallel is named as the cause of the failed step", "[run][run]")
{
    const Scratch in;
    // f reaches 1 at t = 1 s and turns back: the angle acos(f) = 2 asin((1 - t)/2) passes through zero.
    write(in / "m.json", R"({"hilda_model": 1, "name": "turn", "end": 2, "bodies": [
  {"name": "bar", "mass": 2, "inertia": [0.2, 0.001, 0.2], "r": [0, 0.25, 0.43301270189221935], "axis_angle": [1, 0, 0, 1.0471975511965976]}],
 "constraints": [{"name": "pivot", "type": "revolute", "body_i": "ground", "body_j": "bar",
   "s_bar_q_j": [0, -0.5, 0], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]},
  {"name": "drive", "type": "DP1", "body_i": "ground", "body_j": "bar", "a_bar_i": [0, 1, 0], "a_bar_j": [0, 1, 0], "f": "1-(1-t)^2/2"}]})");
    for (const char* scheme : {"rA-half-1", "rA-half-1-momentum", "rA-rattle", "rA-rkmk-4", "rA-genalpha",
                               "rp-bdf2", "ida-rp", "ida-rp-index1"}) {
        const Ended ended =
            call(in, {"run", "m.json", "--fix-initial", "--integrator", scheme, "--output", "a", "--force"});
        CAPTURE(scheme, ended.err);
        CHECK(ended.code == 4);
        CHECK_THAT(ended.err, Contains("  constraint 'drive' row 1; bodies 'ground', 'bar': |f| is ") &&
                                  Contains(" of |a_i||a_j| at t = ") &&
                                  Contains("prescribe the angle with a hinge-driver"));
    }
}

TEST_CASE("a violated dropped row ends the run", "[run][run]")
{
    const Scratch in;
    // t^4 agrees with 0 in position, velocity and acceleration at the start, and differs later
    write(in / "bar.json", pendulum(R"(, {"name": "again", "type": "CD", "body_i": "bar", "body_j": "ground",
        "c": [1, 0, 0], "s_bar_p_i": [0, -1, 0], "s_bar_q_j": [0, 0, 0], "f": "t^4"})"));
    const Ended ended = call(in, {"run", "bar.json", "--interval", "0", "--output", "a"});
    CAPTURE(ended.err);
    CHECK(ended.code == 4);
    CHECK_THAT(ended.err, StartsWith("hilda: warning: constraint 'again' row 1") &&
                              Contains("hilda: error[constraint_drift]: t=0.03"));
    const ordered_json summary = summary_in(in / "a");
    CHECK(summary["status"] == "constraint_drift");
    CHECK(summary["model"]["dropped_rows"].size() == 1);
    // A study detects the violation in its reference solution, and a run detects it between output rows.
    CHECK(call(in, {"study", "convergence", "--problem", "bar.json", "--steps", "1e-2", "--no-plot"}).code ==
          4);
    CHECK(call(in, {"run", "bar.json", "--interval", "1", "--output", "b"}).code == 4);
}

TEST_CASE("extreme values of the summary are taken over all nodes, for any output interval", "[run][run]")
{
    const Scratch in;
    const auto largest = [&](const std::string& interval) {
        const Ended ended = call(in, {"run", "slider_crank", "--end", "0.5", "--interval", interval,
                                      "--output", "e" + interval, "--json"});
        return ordered_json::parse(ended.out)["invariants"];
    };
    const ordered_json dense = largest("0.001"), sparse = largest("0.5");
    for (const char* key : {"energy_drift", "constraint_norm", "orthogonality"}) {
        INFO(key);
        REQUIRE(dense.contains(key));
        CHECK(dense[key] == sparse[key]);
    }
}

TEST_CASE("a model is written through a symbolic link and to a device", "[run][models]")
{
    const Scratch in;
    write(in / "real.json", "old");
    fs::create_symlink("real.json", in / "link.json");
    CHECK(call(in, {"models", "heavy_top", "--write", "link.json"}).code == 0);
    CHECK(fs::is_symlink(in / "link.json"));
    CHECK_THAT(read(in / "real.json"), Contains("hilda_model"));
    CHECK(call(in, {"models", "heavy_top", "--write", "/dev/null"}).code == 0);
    CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("a study rejects invalid steps, keys and names before it computes", "[run][convergence]")
{
    const Scratch in;
    CHECK(call(in, {"study", "convergence", "--problem", "double_pendulum", "--steps", "7e-3"}).code == 2);
    CHECK(call(in, {"study", "convergence", "--expect", "ordr=2"}).code == 2);
    CHECK(call(in, {"study", "convergence", "--problem", "double_pendulum,double_pendulum"}).code == 2);
    CHECK(call(in, {"study", "convergence", "--problem", "nowhere.json"}).code == 3);
}

TEST_CASE("a full disk exits with 5 and the message names the file", "[run][run]")
{
    const Scratch in;
    const std::vector<std::string> arguments = {"run", "double_pendulum", "--interval", "0", "--output",
                                                "a",   "--quiet"};
    const Ended ended = call(in, arguments, {.file_bytes = 100000});
    CHECK(ended.code == 5);
    CHECK_THAT(ended.err, StartsWith("hilda: error: a/trajectory.csv: cannot be written"));
    CHECK_FALSE(fs::exists(in / "a/summary.json"));

    // the model file does not fit either, and its temporary file is removed
    CHECK(call(in, {"run", "double_pendulum", "--output", "b", "--quiet"}, {.file_bytes = 10}).code == 5);
    CHECK(fs::is_empty(in / "b"));
}

TEST_CASE("check prints the properties of a model and writes no file", "[run][check]")
{
    const Scratch in;
    const Ended ended = call(in, {"check", "slider_crank"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("degrees of freedom") && Contains("largest reaction"));
    const ordered_json facts = ordered_json::parse(call(in, {"check", "slider_crank", "--json"}).out);
    CHECK(facts["bodies"] == 3);
    CHECK(facts["rank"] == 18);
    CHECK(facts["degrees_of_freedom"] == 0);
    CHECK_FALSE(fs::exists(in / "out"));

    // point-on-curve is a general constraint: 3 rows and 1 algebraic variable
    const std::string couplings = std::string(test_data) + "/models/couplings.json";
    CHECK_THAT(call(in, {"check", couplings}).out, Contains("9 with 32 rows of rank 32"));
}

TEST_CASE("an inconsistent initial state is rejected, or projected by --fix-initial", "[run][check]")
{
    const Scratch in;
    write(in / "bar.json", pendulum());
    const std::vector<std::string> off = {"check", "bar.json", "--json", "--set",
                                          "/bodies/0/r=[0, 1.001, 0]"};
    const Ended refused = call(in, off);
    CHECK(refused.code == 3);
    CHECK_THAT(refused.err, Contains("hinge") && Contains("--fix-initial"));
    std::vector<std::string> fixed = off;
    fixed.emplace_back("--fix-initial");
    const ordered_json facts = ordered_json::parse(call(in, fixed).out);
    CHECK(facts["fix_initial"]["projected"] == true);
    CHECK(facts["fix_initial"]["r"]["value"] == Approx(1e-3).epsilon(0.01));
}
