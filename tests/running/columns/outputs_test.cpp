// SPDX-License-Identifier: GPL-3.0-or-later
/// outputs.csv of a run: expressions in the columns of the run, resumption, errors.
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// A physical pendulum of length 1 m about x with a torsion spring, a ball above a floor, and these outputs
std::string model_with(const std::string& outputs)
{
    return R"({"hilda_model": 1, "name": "p", "end": 1, "bodies": [
  {"name": "bar", "mass": 2, "inertia": [0.2, 1e-3, 0.2], "r": [0, 0.5, 0]},
  {"name": "ball", "mass": 2, "inertia": [0.008, 0.008, 0.008], "r": [3, 0, 0.1], "r_dot": [1, 0, 0]}],
 "constraints": [{"name": "pivot", "type": "revolute", "body_i": "ground", "body_j": "bar",
   "s_bar_q_j": [0, -0.5, 0], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}],
 "forces": [{"name": "coil", "type": "torsion-spring", "body_i": "ground", "body_j": "bar",
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0], "stiffness": 1, "free_angle": 0}],
 "contacts": [{"name": "ball-floor", "body_i": "ball", "body_j": "ground",
   "surface_i": {"type": "sphere", "radius": 0.1}, "surface_j": {"type": "plane"},
   "normal": {"type": "hooke", "stiffness": 1e4}, "friction": {"mu_s": 0.2, "K_E": 1e4}}],
 "outputs": [)" +
           outputs + "]}";
}

}  // namespace

TEST_CASE("expressions in the outputs use the columns of bodies, forces, contacts and other outputs",
          "[run][outputs]")
{
    const Scratch in;
    write(in / "p.json", model_with(R"json(
  {"name": "tip", "type": "point", "body": "bar", "point_bar": [0, 0.5, 0]},
  {"name": "swing", "type": "angle", "body_i": "ground", "body_j": "bar", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]},
  {"name": "reach", "type": "expression", "value": "sqrt(tip.x^2 + tip.y^2 + tip.z^2)", "unit": "m"
},
  {"name": "speed", "type": "expression", "value": "bar.wx - swing.rate"},
  {"name": "coil law", "type": "expression", "value": "coil.torque - 1*swing.angle + 0*{ball-floor.F_N}"},
  {"name": "mu", "type": "expression", "value": "if({ball-floor.F_N}, abs({ball-floor.Ff_x})/{ball-floor.F_N}, 0) + 0*energy + 0*reach"},
  {"name": "time", "type": "expression", "value": "t"})json"));
    const Ended ended = call(in, {"run", "p.json", "--integrator", "rA-half-1", "--step", "1e-3",
                                  "--interval", "0.01", "--output", "out"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK(first_line(read(in / "out/outputs.csv")) ==
          "t,tip.x,tip.y,tip.z,tip.vx,tip.vy,tip.vz,tip.ax,tip.ay,tip.az,swing.angle,swing.rate,reach,speed,"
          "coil law,mu,time");
    const auto rows = csv(in / "out/outputs.csv"), motion = csv(in / "out/trajectory.csv");
    REQUIRE(rows.size() == motion.size());
    REQUIRE(rows.size() == 101);
    for (size_t k = 0; k < rows.size(); ++k) {
        CHECK(number(rows[k], "tip.y") == Approx(2 * number(motion[k], "bar.ry")).margin(1e-9));
        const double arm = number(rows[k], "tip.y") - number(motion[k], "bar.ry");
        CHECK(number(rows[k], "tip.vz") ==
              Approx(number(motion[k], "bar.vz") + number(motion[k], "bar.wx") * arm).margin(1e-12));
        CHECK(number(rows[k], "reach") == Approx(1).epsilon(1e-9));
        CHECK(std::abs(number(rows[k], "speed")) < 1e-12);
        CHECK(std::abs(number(rows[k], "coil law")) < 1e-9);
        // The ball slides until t = 2 v_0/(7 mu g) = 0.146 s and then rolls.
        if (k > 0 && k < 14) CHECK(number(rows[k], "mu") == Approx(0.2).epsilon(1e-3));
        if (k > 20) CHECK(number(rows[k], "mu") < 0.1);
        CHECK(rows[k].at("time") == rows[k].at("t"));
    }
    CHECK_THAT(read(in / "out/summary.json"), Contains("outputs.csv"));
}

TEST_CASE("an output that is not finite is written as nan, with one warning", "[run][outputs]")
{
    const Scratch in;
    write(in / "p.json",
          model_with(R"x({"name": "root", "type": "expression", "value": "-sqrt(0.5 - t)"})x"));
    const Ended ended = call(in, {"run", "p.json", "--step", "1e-3", "--interval", "0.1", "--output", "out"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.err, Contains("warning: outputs.csv: root is not finite at t = 0.6 s"));
    CHECK(ended.err.find("root", ended.err.find("root") + 1) == std::string::npos);
    CHECK(csv(in / "out/outputs.csv").back().at("root") == "nan");
}

TEST_CASE("an output that names an unknown column is rejected with its place before the run",
          "[run][outputs]")
{
    const Scratch in;
    const auto rejected = [&](const std::string& output, const std::string& message) {
        write(in / "p.json", model_with("\n" + output));
        for (const std::string command : {"run", "check"}) {
            CAPTURE(command, message);
            check_refused(in, {command, "p.json"}, 3, "p.json:12:");
            check_refused(in, {command, "p.json"}, 3, message);
        }
    };
    const auto expression = [](const std::string& value) {
        return R"({"name": "x", "type": "expression", "value": ")" + value + "\"}";
    };
    rejected(expression("bar.rxx"), "unknown name 'bar.rxx'");
    rejected(expression("bar.rxx"), "did you mean 'bar.rx'");
    rejected(expression("{ball-flor.F_N}"), "did you mean 'ball-floor.F_N'");
    rejected(expression("ball-floor.F_N"), "write {ball-floor.F_N} in braces");
    rejected(expression("{bar.rx"), "'{' is never closed");
    rejected(expression("2*"), "ends where a value is expected");
    rejected(expression("x"), "unknown name 'x'");  // an output does not see itself
    rejected(R"({"name": "bar", "type": "point", "body": "bar"})",
             "/outputs/0/name): the column 'bar.vx' exists already");
    rejected(R"({"name": "energy", "type": "expression", "value": "bar.rx"})",
             "/outputs/0/name): the column 'energy' exists already");
}

TEST_CASE("a killed and resumed run writes the outputs of an uninterrupted run", "[run][outputs][resume]")
{
    const Scratch in;
    write(in / "p.json",
          model_with(R"({"name": "turns", "type": "angle", "body_i": "ground", "body_j": "ball",
        "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]})"));
    check_resumed(in,
                  {"run", "p.json", "--end", "2", "--set", "/bodies/1/r_dot=[4, 0, 0]", "--interval", "0.01"},
                  {{SIGKILL, 400}, {SIGKILL, 300}});
    const auto rows = csv(in / "whole/outputs.csv");
    CHECK(number(rows[70], "turns.angle") > 6.3);  // more than a turn before the second kill
    CHECK(number(rows.back(), "turns.angle") > 20);
}

namespace {

/// A rotor of inertia 2 kg m² with 500 rad/s about z at the start, under this torque [N m], and its angle
std::string rotor(const std::string& torque)
{
    return R"({"hilda_model": 1, "name": "rotor", "gravity": [0, 0, 0], "bodies": [
  {"name": "rotor", "mass": 1, "inertia": [1, 1, 2], "r": [0, 0, 0], "omega": [0, 0, 500]}],
 "constraints": [{"name": "hinge", "type": "revolute", "body_i": "ground", "body_j": "rotor",
   "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}],
 "forces": [{"name": "T", "type": "torque", "body": "rotor", "frame": "global", "components": [0, 0, ")" +
           torque + R"("]}],
 "outputs": [{"name": "phi", "type": "angle", "body_i": "ground", "body_j": "rotor", "axis_bar_i": [0, 0, 1],
   "axis_bar_j": [0, 0, 1]}, {"name": "twice", "type": "expression", "value": "2*phi.angle - t"}]})";
}

}  // namespace

TEST_CASE("the angle of a rotor is right at output intervals of many turns with every adaptive scheme",
          "[run][outputs][adaptive]")
{
    const Scratch in;
    const auto check = [&](const std::string& scheme, const std::string& torque, const auto& phi) {
        CAPTURE(scheme, torque);
        write(in / "m.json", rotor(torque));
        const Ended ended = call(in, {"run", "m.json", "--integrator", scheme, "--rtol", "1e-8", "--end", "4",
                                      "--interval", "1", "--output", scheme, "--force"});
        CAPTURE(ended.err);
        REQUIRE(ended.code == 0);
        const auto rows = csv(in / (scheme + "/outputs.csv"));
        REQUIRE(rows.size() == 5);
        for (const auto& row : rows) {
            const double t = number(row, "t");
            // The orientation itself drifts by 2 rad with ida-rp-index1.
            CHECK(number(row, "phi.angle") == Approx(phi(t)).margin(scheme == "ida-rp-index1" ? 3 : 0.05));
            CHECK(number(row, "twice") == Approx(2 * number(row, "phi.angle") - t));
        }
    };
    for (const std::string scheme : {"rA-dp-5", "rA-dop853", "rA-radau-5", "ida-rp", "ida-rp-index1"}) {
        check(scheme, "0", [](double t) { return 500 * t; });
        // It turns back after 2.2 s. The mean of the rates of two rows is wrong by 88 rad.
        check(scheme, "-300*t^2", [](double t) { return 500 * t - 12.5 * std::pow(t, 4); });
    }
    check("rA-rattle-adaptive", "-600", [](double t) { return 500 * t - 150 * t * t; });
}

TEST_CASE("a resumed adaptive run continues the count of turns", "[run][outputs][adaptive][resume]")
{
    const Scratch in;
    write(in / "m.json", rotor("-300*t^2"));
    for (const std::string scheme : {"rA-dp-5", "rA-dop853", "rA-radau-5"}) {
        CAPTURE(scheme);
        const std::vector<std::string> options = {"run", "m.json", "--integrator", scheme,     "--interval",
                                                  "1",   "--rtol", "1e-8",         "--output", scheme};
        REQUIRE(call(in, with(options, {"--end", "2", "--checkpoint", "1"})).code == 0);
        const Ended resumed = call(in, with(options, {"--resume", "--end", "4"}));
        CAPTURE(resumed.err);
        REQUIRE(resumed.code == 0);
        const auto rows = csv(in / (scheme + "/outputs.csv"));
        REQUIRE(rows.size() == 5);
        CHECK(number(rows.back(), "phi.angle") == Approx(500 * 4 - 12.5 * 256).margin(0.01));
    }
}

TEST_CASE("an event on an angle is found after many turns of an adaptive run", "[run][outputs][adaptive]")
{
    const Scratch in;
    std::string model = rotor("0");
    model.replace(model.rfind('}'), 1,
                  R"(, "events": [{"name": "turned", "value": "phi.angle - 1000.5", "action": "stop"}]})");
    write(in / "m.json", model);
    for (const std::string scheme : {"rA-dp-5", "rA-dop853", "rA-radau-5"}) {
        CAPTURE(scheme);
        const Ended ended = call(in, {"run", "m.json", "--integrator", scheme, "--rtol", "1e-8", "--end",
                                      "10", "--interval", "1", "--output", scheme});
        CAPTURE(ended.err);
        REQUIRE(ended.code == 0);
        CHECK(number(csv(in / (scheme + "/events.csv")).at(0), "t") == Approx(2.001).epsilon(1e-9));
        CHECK(number(csv(in / (scheme + "/outputs.csv")).back(), "phi.angle") ==
              Approx(1000.5).epsilon(1e-9));
    }
}
