// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda kinematics: motion and driver loads of driven mechanisms, against time integration and a closed
/// form.
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

/// A bar of 1 kg and 1 m that is turned about x by angle = t^2
const std::string driven_bar_file = R"({"hilda_model": 1, "name": "bar", "end": 1,
 "bodies": [{"name": "bar", "mass": 1, "inertia": [0.25, 0.001, 0.25], "r": [0, 0.5, 0]}],
 "constraints": [
  {"name": "pivot", "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, -0.5, 0],
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]},
  {"name": "motor", "type": "hinge-driver", "body_i": "ground", "body_j": "bar", "axis_bar_i": [1, 0, 0],
   "axis_bar_j": [1, 0, 0], "angle": "t^2"}]})";

}  // namespace

TEST_CASE("kinematics computes the motion and the torque of a driven bar", "[run][kinematics]")
{
    const Scratch in;
    write(in / "bar.json", driven_bar_file);
    const Ended ended = call(in, {"kinematics", "bar.json", "--interval", "0.05", "--reactions"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    CHECK_THAT(ended.out, Contains("21 rows"));
    const auto rows = csv(in / "out/bar/trajectory.csv");
    REQUIRE(rows.size() == 21);
    for (const CsvRow& row : rows) {
        const double t = number(row, "t"), angle = t * t;
        CHECK(number(row, "bar.ry") == Approx(0.5 * std::cos(angle)).margin(1e-12));
        CHECK(number(row, "bar.rz") == Approx(0.5 * std::sin(angle)).margin(1e-12));
        CHECK(number(row, "bar.wx") == Approx(2 * t).margin(1e-11));
        CHECK(number(row, "bar.alx") == Approx(2).epsilon(1e-9));
        // The constraint loads on the bar are the force of the pivot and the torque of the motor, which is
        // J alpha + m g l/2 cos(angle) with J = 0.25 + 1/4.
        const double y = -number(row, "bar.ry"), z = -number(row, "bar.rz");  // arm of the pivot
        const double motor = number(row, "bar.Tx") - (y * number(row, "bar.Fz") - z * number(row, "bar.Fy"));
        CHECK(motor == Approx(0.5 * 2 + 9.81 * 0.5 * std::cos(angle)).epsilon(1e-9));
    }
}

TEST_CASE("kinematics and time integration give the same motion of a driven mechanism", "[run][kinematics]")
{
    const Scratch in;
    REQUIRE(call(in, {"kinematics", "four_link", "--end", "1", "--interval", "0.1", "--output", "k"}).code ==
            0);
    REQUIRE(call(in, {"run", "four_link", "--integrator", "rA-rkmk-4", "--end", "1", "--interval", "0.1",
                      "--output", "r"})
                .code == 0);
    const auto k = csv(in / "k/trajectory.csv"), r = csv(in / "r/trajectory.csv");
    REQUIRE(k.size() == r.size());
    for (size_t n = 0; n < k.size(); ++n)
        for (const auto& [column, text] : k[n])
            if (column != "constraint_norm" && column != "energy")
                CHECK(std::stod(text) == Approx(number(r[n], column)).margin(1e-6).epsilon(1e-7));
}

TEST_CASE("kinematics replaces the files of a run, and writes the projected initial data",
          "[run][kinematics]")
{
    const Scratch in;
    std::string moved = driven_bar_file;
    moved.replace(moved.find("[0, 0.5, 0]"), 11, "[0, 0.52, 0]");
    write(in / "bar.json", moved);
    REQUIRE(call(in, {"run", "bar.json", "--fix-initial", "--end", "0.1", "--output", "d"}).code == 0);
    REQUIRE(fs::exists(in / "d/checkpoint.end"));
    CHECK(call(in, {"kinematics", "bar.json", "--output", "d", "--force"}).code ==
          3);  // 0.02 m off the pivot
    REQUIRE(call(in, {"kinematics", "bar.json", "--fix-initial", "--output", "d", "--force"}).code == 0);
    CHECK_FALSE(fs::exists(in / "d/checkpoint.end"));
    CHECK(call(in, {"check", "d/model.json"}).code == 0);
}

TEST_CASE("kinematics counts the turns between two rows and ends at the end", "[run][kinematics][outputs]")
{
    const Scratch in;
    std::string model = driven_bar_file;
    model.replace(model.find("t^2"), 3, "20*t");
    model.insert(model.rfind('}'), R"(, "outputs": [{"name": "turn", "type": "angle", "body_i": "ground",
        "body_j": "bar", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}])");
    write(in / "bar.json", model);
    REQUIRE(call(in, {"kinematics", "bar.json", "--fix-initial", "--interval", "0.7", "--end", "2"}).code ==
            0);
    const auto rows = csv(in / "out/bar/outputs.csv");
    REQUIRE(rows.size() == 4);
    for (const CsvRow& row : rows)
        CHECK(number(row, "turn.angle") == Approx(20 * number(row, "t")).margin(1e-9));
    CHECK(number(rows.back(), "t") == Approx(2).epsilon(1e-12));
}

TEST_CASE("kinematics rejects a model with degrees of freedom before it writes a file", "[run][kinematics]")
{
    const Scratch in;
    check_refused(in, {"kinematics", "double_pendulum"}, 3, "without degrees of freedom, got 2");
}

TEST_CASE("kinematics has its name in the errors of the options that it shares with run", "[run][kinematics]")
{
    const Scratch in;
    for (const std::string option : {"--contacts", "--forces"}) {
        CHECK_THAT(call(in, {"kinematics", "four_link", option}).err,
                   StartsWith("hilda: error: kinematics: " + option + " writes "));
        CHECK_THAT(call(in, {"run", "four_link", option}).err, StartsWith("hilda: error: run: " + option));
    }
    // There is no integrator: all columns but the time would be zero.
    check_refused(in, {"kinematics", "four_link", "--log-steps"}, 2,
                  "kinematics: --log-steps is for the steps of an integrator; hilda run has them");
    CHECK_FALSE(fs::exists(in / "out"));
}

TEST_CASE("help outputs lists the columns of the tables", "[run][help]")
{
    const Scratch in;
    const Ended ended = call(in, {"help", "outputs"});
    REQUIRE(ended.code == 0);
    for (const char* text :
         {"BODY.rx, ry, rz\n      [m] position of the centre of mass", "SPRING.force\n      [N]",
          "CONTACT.F_N\n      [N] normal force", "POINT.vx, vy, vz", "ANGLE.angle", "LENGTH.rate"})
        CHECK_THAT(ended.out, Contains(text));
    std::istringstream lines(ended.out);
    for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 110);
}
