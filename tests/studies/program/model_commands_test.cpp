// SPDX-License-Identifier: GPL-3.0-or-later
/// Commands on a model file: parameters, projected initial data, Euler angles.
#include "lie/euler_sequence.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sys/stat.h>

#include <numbers>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

/// A pendulum of length l, driven by an angle, whose tip is `off` metres away from its bearing
std::string driven(const std::string& parameters)
{
    return R"({"hilda_model": 1, "name": "driven", "end": 0.2,
 "parameters": )" +
           parameters + R"(,
 "bodies": [{"name": "bar", "mass": "rho*l", "shape": {"cylinder": [0.01, "l"], "axis": "y"}, "r": ["off", "l/2", 0],
             "omega": ["2*pi", 0, 0], "r_dot": [0, 0, "pi*l"]}],
 "constraints": [
  {"name": "pin", "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, "-l/2", 0],
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]},
  {"name": "turn", "type": "hinge-driver", "body_i": "ground", "body_j": "bar", "axis_bar_i": [1, 0, 0],
   "axis_bar_j": [1, 0, 0], "angle": "turns*2*pi*t"}]}
)";
}

/// A table by columns
struct Csv {
    std::vector<CsvRow> rows;
    std::vector<double> column(const std::string& name) const
    {
        std::vector<double> values;
        for (const CsvRow& row : rows) values.push_back(number(row, name));
        return values;
    }
};
Csv read_csv(const fs::path& file) { return {csv(file)}; }

const std::string consistent = R"({"l": 0.5, "rho": 4, "off": 0, "turns": 1})",
                  moved = R"({"l": 0.5, "rho": 4, "off": 0.1, "turns": 1})";

}  // namespace

TEST_CASE("a model with parameters is run with other values by --set", "[studies][parameters]")
{
    const Scratch in;
    write(in / "d.json", driven(consistent));
    REQUIRE(call(in, {"run", "d.json", "--output", "a"}).code == 0);
    REQUIRE(call(in, {"run", "d.json", "--set", "/parameters/l=1", "--output", "b"}).code == 0);
    const Csv a = read_csv(in / "a" / "trajectory.csv"), b = read_csv(in / "b" / "trajectory.csv");
    CHECK(a.column("bar.ry").front() == 0.25);
    CHECK(b.column("bar.ry").front() == 0.5);
    // the driven tip is at twice the distance at all times
    for (size_t k = 0; k < a.column("bar.rz").size(); k += 20)
        CHECK(b.column("bar.rz")[k] == Approx(2 * a.column("bar.rz")[k]).margin(1e-12));
    CHECK(nlohmann::json::parse(read(in / "b" / "summary.json"))["model"]["parameters"]["l"] == 1);
    // the model of the output folder has the numbers and gives the same run
    CHECK_THAT(read(in / "b" / "model.json"), !Contains("parameters") && Contains("\"mass\": 4"));
    REQUIRE(call(in, {"run", "b/model.json", "--output", "c"}).code == 0);
    CHECK(read(in / "c" / "trajectory.csv") == read(in / "b" / "trajectory.csv"));

    const Ended check = call(in, {"check", "d.json", "--set", "/parameters/rho=\"2*l\""});
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("parameters          l = 0.5, rho = 1, off = 0, turns = 1"));
    const auto json = nlohmann::json::parse(call(in, {"check", "d.json", "--json"}).out);
    CHECK(json["parameters"]["rho"] == 4);
}

TEST_CASE("an error in a parameter or an expression is one line with exit code 3", "[studies][parameters]")
{
    const Scratch in;
    write(in / "d.json", driven(consistent));
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"/parameters/l=\"rho/off\"",
         "d.json:2:22 (/parameters/l): \"rho/off\" must be finite, got inf with rho = 4, off = 0"},
        {"/parameters/l=\"2*l\"",
         "d.json:2:22 (/parameters/l): the parameters depend on each other in a cycle: l -> l"},
        {"/parameters/len=2", "(/parameters/len): the model does not use a parameter \"len\""},
        {"/bodies/0/mass=\"2*roh\"",
         "d.json:3:37 (/bodies/0/mass): mass must be a number or an expression: unknown name 'roh' in "
         "\"2*roh\" at column 3; did you mean 'rho'?"},
        {"/bodies/0/mass=\"2*(l\"",
         "(/bodies/0/mass): mass must be a number or an expression: '(' is never closed"},
        {"/constraints/1/angle=2*tunrs*t",
         "(/constraints/1/angle): unknown name 'tunrs' in \"2*tunrs*t\" at column 3; did you mean 'turns'?"}};
    for (const std::string command : {"check", "run"})
        for (const auto& [set, expected] : wrong) {
            const Ended ended = call(in, {command, "d.json", "--set", set});
            CAPTURE(set, ended.err);
            CHECK(ended.code == 3);
            CHECK_THAT(ended.err, StartsWith("hilda: error: d.json:") && Contains(expected));
            CHECK(ended.err.find('\n') == ended.err.size() - 1);
        }
    CHECK_FALSE(fs::exists(in / "out"));
}

TEST_CASE(
    "a start off by a distance is refused with the distance, and check --fix writes the projected model",
    "[studies][check]")
{
    const Scratch in;
    write(in / "m.json", driven(moved));
    const Ended refused = call(in, {"check", "m.json"});
    CHECK(refused.code == 3);
    CHECK_THAT(
        refused.err,
        Contains(
            "the initial positions violate constraint 'pin' row 1; bodies 'ground', 'bar' by 0.1 m, more"));
    const Ended fixed = call(in, {"check", "m.json", "--fix", "f.json"});
    CHECK(fixed.code == 0);
    CHECK_THAT(fixed.out, Contains("position residual   0.1 m, constraint 'pin' row 1") &&
                              Contains("r                 1.000e-01 m on 'bar'") &&
                              Contains("written             f.json"));
    const Ended again = call(in, {"check", "f.json"});
    CAPTURE(again.err);
    CHECK(again.code == 0);
    CHECK(again.err.empty());
    // The projection of this offset along the axis moves the bar back.
    const auto body = nlohmann::json::parse(read(in / "f.json"))["bodies"][0];
    CHECK(std::abs(body["r"][0].get<double>()) < 1e-12);
    CHECK(body["omega"][0].get<double>() == Approx(2 * std::numbers::pi));
    CHECK_FALSE(fs::exists(in / "out"));
    CHECK(call(in, {"check", "m.json", "--fix", "no/f.json"}).code == 5);
    const Ended itself = call(in, {"check", "m.json", "--fix", "./m.json"});
    CHECK(itself.code == 2);
    CHECK_THAT(itself.err, Contains("--fix would replace the model m.json itself; give another file"));
    CHECK(read(in / "m.json") == driven(moved));
    const Ended as_json = call(in, {"check", "m.json", "--fix", "j.json", "--json"});
    CHECK(nlohmann::json::parse(as_json.out)["fix_initial"]["projected"] == true);
    CHECK(read(in / "j.json") == read(in / "f.json"));
}

TEST_CASE("check --fix keeps the notes of the model file", "[studies][check]")
{
    const Scratch in;
    auto model = nlohmann::ordered_json::parse(driven(moved));
    model["note"] = "whole", model["bodies"][0]["note"] = "bar", model["constraints"][0]["note"] = "pin";
    write(in / "m.json", model.dump());
    REQUIRE(call(in, {"check", "m.json", "--fix", "f.json"}).code == 0);
    const auto fixed = nlohmann::ordered_json::parse(read(in / "f.json"));
    CHECK(fixed["note"] == "whole");
    CHECK(fixed["bodies"][0]["note"] == "bar");
    CHECK(fixed["constraints"][0]["note"] == "pin");
    CHECK(call(in, {"check", "f.json"}).code == 0);
}

TEST_CASE("a model that is a pipe or a folder has the same error in all commands", "[studies][check]")
{
    const Scratch in;
    REQUIRE(mkfifo((in / "pipe.json").c_str(), 0600) == 0);
    fs::create_directory(in / "folder.json");
    for (const std::string model : {"pipe.json", "folder.json"}) {
        const std::string message = "hilda: error: " + model + ": a model file must be a regular file\n";
        for (const std::vector<std::string>& command :
             std::vector<std::vector<std::string>>{{"check", model},
                                                   {"run", model},
                                                   {"study", "energy", "--json", "--problem", model},
                                                   {"study", "energy", "--problem", model}}) {
            const Ended ended = call(in, command);
            CHECK(ended.code == 3);
            CHECK(ended.err == message);
        }
    }
    CHECK_FALSE(fs::exists(in / "out/energy/study.part"));
}

TEST_CASE("the model.json of a run with --fix-initial passes a check and repeats the run", "[studies][check]")
{
    const Scratch in;
    write(in / "m.json", driven(moved));
    REQUIRE(call(in, {"run", "m.json", "--fix-initial", "--output", "a"}).code == 0);
    CHECK(call(in, {"check", "a/model.json"}).code == 0);
    REQUIRE(call(in, {"run", "a/model.json", "--output", "b"}).code == 0);
    const Csv a = read_csv(in / "a" / "trajectory.csv"), b = read_csv(in / "b" / "trajectory.csv");
    for (const std::string column : {"bar.rx", "bar.ry", "bar.rz"})
        CHECK(a.column(column).back() == Approx(b.column(column).back()).margin(1e-11));
    // Consistent data are written as they are.
    write(in / "c.json", driven(consistent));
    REQUIRE(call(in, {"run", "c.json", "--output", "c"}).code == 0);
    REQUIRE(call(in, {"run", "c.json", "--fix-initial", "--output", "d"}).code == 0);
    CHECK(read(in / "c" / "model.json") == read(in / "d" / "model.json"));
}

TEST_CASE("a study of a model with an inconsistent start takes --fix-initial", "[studies][check]")
{
    const Scratch in;
    write(in / "m.json", driven(moved));
    const std::vector<std::string> study = {"study",   "convergence",  "--problem",
                                            "m.json",  "--integrator", "rA-half-2",
                                            "--steps", "4e-3,2e-3",    "--no-plot"};
    const Ended refused = call(in, study);
    CHECK(refused.code == 3);
    CHECK_THAT(refused.err, Contains("use --fix-initial"));
    std::vector<std::string> fixed = study;
    fixed.emplace_back("--fix-initial");
    const Ended done = call(in, fixed);
    CAPTURE(done.err);
    CHECK(done.code == 0);
    CHECK(nlohmann::json::parse(read(in / "out" / "convergence" / "study.json"))["fix_initial"] == true);
    CHECK(call(in, {"study", "granular-waves", "--fix-initial"}).code == 2);
}

TEST_CASE("the usual names of joints are refused with the name that HILDA has", "[studies][check]")
{
    const Scratch in;
    for (const auto& [name, meant] : {std::pair("prismatic", "translational"),
                                      {"Hinge", "revolute"},
                                      {"ball", "spherical"},
                                      {"ball_and_socket", "spherical"},
                                      {"weld", "fixed"}}) {
        std::string text = pendulum();
        const size_t at = text.find("\"revolute\"");
        write(in / "m.json", text.replace(at, 10, std::string("\"") + name + "\""));
        const Ended ended = call(in, {"check", "m.json"});
        CHECK(ended.code == 3);
        CHECK_THAT(ended.err, Contains(std::string("(/constraints/0/type): unknown type \"") + name +
                                       "\"; did you mean '" + meant + "'?"));
    }
}

TEST_CASE(
    "a run writes Euler angles that are continuous through whole turns and continues them after a resume",
    "[studies][euler]")
{
    const Scratch in;
    // one turn in 0.05 s about the x axis, and about no other axis
    const std::vector<std::string> fast = {"run",     "d.json",
                                           "--set",   "/parameters/turns=20",
                                           "--set",   "/bodies/0/omega/0=\"40*pi\"",
                                           "--set",   "/bodies/0/r_dot/2=\"20*pi*l\"",
                                           "--euler", "xyz"};
    write(in / "d.json", driven(consistent));
    const Ended done = call(in, with(fast, {"--output", "a"}));
    CAPTURE(done.err);
    REQUIRE(done.code == 0);
    const Csv angles = read_csv(in / "a" / "euler.csv"), motion = read_csv(in / "a" / "trajectory.csv");
    REQUIRE(angles.column("bar.angle1").size() == motion.column("t").size());
    for (size_t k = 0; k < angles.column("t").size(); k += 10) {
        const double t = angles.column("t")[k];
        CHECK(angles.column("bar.angle1")[k] == Approx(40 * std::numbers::pi * t).margin(1e-9));
        CHECK(std::abs(angles.column("bar.angle2")[k]) < 1e-9);
        const lie::Vec3 eps(angles.column("bar.angle1")[k], angles.column("bar.angle2")[k],
                            angles.column("bar.angle3")[k]);
        const lie::Mat3 A = lie::EulerSequence::named("xyz")->rotation(eps);
        CHECK(A(1, 2) == Approx(motion.column("bar.A23")[k]).margin(1e-12));
    }

    check_refused(in, {"run", "d.json", "--euler", "zzx", "--output", "w"}, 2,
                  "--euler: must be three of the letters x, y and z in which neighbours differ");
    CHECK_THAT(first_line(read(in / "a" / "euler.csv")), Contains("bar.angle1"));
    REQUIRE(call(in, {"run", "d.json", "--euler", "zxz", "--output", "z"}).code == 0);
    CHECK(first_line(read(in / "z" / "euler.csv")) == "t,bar.theta,bar.phi,bar.psi");
    REQUIRE(call(in, {"run", "d.json", "--output", "z", "--force"}).code == 0);
    CHECK_FALSE(fs::exists(in / "z" / "euler.csv"));
}

// Rows 0.11 s apart, with 3.3 turns between two rows. The first body spins about a fixed axis, the second one
// nods at the same time, the third one speeds up.
TEST_CASE("Euler angles count the turns between two rows of each integrator", "[studies][run][euler]")
{
    const std::string integrator =
        GENERATE("rA-half-2", "rA-rkmk-4", "ida-rp", "ida-rp-baumgarte", "ida-rp-index1");
    CAPTURE(integrator);
    const Scratch in;
    write(in / "spin.json", R"({"hilda_model": 1, "name": "spin", "end": 1.1, "gravity": [0, 0, 0],
      "parameters": {"rate": "2*pi*3.3/0.11"}, "bodies": [
      {"name": "x", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0], "omega": ["rate", 0, 0]},
      {"name": "back", "mass": 1, "inertia": [1, 1, 1], "r": [1, 0, 0], "omega": ["-rate", 0, 0]},
      {"name": "tilted", "mass": 1, "inertia": [1, 1, 1], "r": [2, 0, 0],
       "euler_angles": {"sequence": "xyz", "angles": [0.2, 0.4, 0.3]}, "omega": [0, 0, "rate"]}]})");
    const std::vector<std::string> step = integrator.starts_with("ida")
                                              ? std::vector<std::string>{"--rtol", "1e-9"}
                                              : std::vector<std::string>{"--step", "1e-3"};
    const Ended ended = call(in, with({"run", "spin.json", "--integrator", integrator, "--interval", "0.11",
                                       "--euler", "xyz", "--output", "a"},
                                      step));
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK(ended.err.find("euler.csv") == std::string::npos);
    const Csv angles = read_csv(in / "a/euler.csv");
    REQUIRE(angles.column("t").size() == 11);
    for (size_t k = 0; k < 11; ++k) {
        const double turned = 2 * std::numbers::pi * 3.3 * static_cast<double>(k);
        CHECK(angles.column("x.angle1")[k] == Approx(turned).margin(1e-4));
        CHECK(angles.column("back.angle1")[k] == Approx(-turned).margin(1e-4));
        CHECK(angles.column("tilted.angle1")[k] == Approx(0.2).margin(1e-4));
        CHECK(angles.column("tilted.angle2")[k] == Approx(0.4).margin(1e-4));
        CHECK(angles.column("tilted.angle3")[k] == Approx(0.3 + turned).margin(1e-4));
    }
}

// The angle 10 t² of a driver: up to 290 turns, with up to 55 turns between two rows
TEST_CASE("Euler angles count the turns of a rotation whose rate changes", "[studies][run][euler]")
{
    const Scratch in;
    write(in / "bar.json", R"({"hilda_model": 1, "name": "bar", "end": 13.5,
      "bodies": [{"name": "bar", "mass": 1, "inertia": [0.25, 0.001, 0.25], "r": [0, 0.5, 0]}],
      "constraints": [{"name": "pivot", "type": "revolute", "body_i": "ground", "body_j": "bar",
        "s_bar_q_j": [0, -0.5, 0], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]},
       {"name": "motor", "type": "hinge-driver", "body_i": "ground", "body_j": "bar", "axis_bar_i": [1, 0, 0],
        "axis_bar_j": [1, 0, 0], "angle": "10*t^2"}]})");
    REQUIRE(call(in, {"run", "bar.json", "--integrator", "ida-rp", "--interval", "1.35", "--euler", "xyz",
                      "--output", "a"})
                .code == 0);
    const Csv angles = read_csv(in / "a/euler.csv");
    REQUIRE(angles.column("t").size() == 11);
    for (size_t k = 0; k < 11; ++k)
        CHECK(angles.column("bar.angle1")[k] ==
              Approx(10 * std::pow(1.35 * static_cast<double>(k), 2)).margin(1e-4));
}

// A symmetric top: ω̄ turns about its axis z with the rate (1 - J_z/J_x) ω_z, which the rows do not resolve.
TEST_CASE("Euler angles whose turns are not certain are written with one warning", "[studies][run][euler]")
{
    const Scratch in;
    write(in / "top.json", R"({"hilda_model": 1, "name": "top", "end": 5, "gravity": [0, 0, 0], "bodies": [
      {"name": "top", "mass": 1, "inertia": [1, 1, 1.9], "r": [0, 0, 0], "omega": [20, 0, 30]}]})");
    const auto run = [&](const std::string& interval, const std::string& integrator) {
        const Ended ended = call(in, {"run", "top.json", "--integrator", integrator, "--interval", interval,
                                      "--euler", "zxz", "--output", "a", "--force"});
        REQUIRE(ended.code == 0);
        return ended.err;
    };
    const std::string warning = run("0.5", "ida-rp");
    CHECK_THAT(warning,
               Contains("warning: --euler: the turns of top are not certain") && Contains("--interval"));
    CHECK(warning.find("not certain") == warning.rfind("not certain"));
    CHECK(run("0.01", "ida-rp").empty());
    const Csv fine = read_csv(in / "a/euler.csv");
    CHECK(run("0.5", "rA-rkmk-4").empty());  // it follows the angles from step to step
    const Csv steps = read_csv(in / "a/euler.csv");
    for (size_t k = 0; k < 11; ++k)
        for (const char* column : {"top.theta", "top.psi"})
            CHECK(steps.column(column)[k] == Approx(fine.column(column)[50 * k]).margin(1e-3));
}
