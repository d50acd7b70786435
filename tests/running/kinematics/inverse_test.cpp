// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda inverse: loads of drivers, and of joints whose motion a CSV file prescribes, against closed forms.
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

const std::string bar = R"(
  {"name": "bar", "mass": 1, "inertia": [0.25, 0.001, 0.25], "r": [0, 0.5, 0]})";
const std::string pivot = R"(
  {"name": "pivot", "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, -0.5, 0],
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]})";

std::string model(const std::string& bodies, const std::string& constraints)
{
    return R"({"hilda_model": 1, "name": "m", "end": 1, "bodies": [)" + bodies + R"(], "constraints": [)" +
           constraints + "]}";
}

/// A bar that is turned about x by t^2
std::string driven_bar()
{
    return model(bar,
                 pivot + R"(, {"name": "motor", "type": "hinge-driver", "body_i": "ground", "body_j": "bar",
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0], "angle": "t^2"})");
}

/// A table with the columns t and `name`, and n + 1 samples of f from 0 to 1 s
template <class F>
std::string table(const std::string& name, int n, const F& f)
{
    std::ostringstream text;
    text.precision(17);
    text << "t," << name << '\n';
    for (int k = 0; k <= n; ++k) text << k / double(n) << ',' << f(k / double(n)) << '\n';
    return text.str();
}

std::vector<CsvRow> drives(const Scratch& in, const std::vector<std::string>& arguments)
{
    const Ended ended =
        call(in, with(with({"inverse"}, arguments), {"--force", "--output", "o", "--no-plot"}));
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    return csv(in / "o/drives.csv");
}

}  // namespace

TEST_CASE("inverse gives the torque and the power of a driver", "[run][kinematics]")
{
    const Scratch in;
    write(in / "m.json", driven_bar());
    const auto rows = drives(in, {"m.json", "--interval", "0.05"});
    REQUIRE(rows.size() == 21);
    for (const CsvRow& row : rows) {
        const double t = number(row, "t"), torque = 0.5 * 2 + 9.81 * 0.5 * std::cos(t * t);
        CHECK(number(row, "motor.value") == t * t);
        CHECK(number(row, "motor.rate") == 2 * t);
        CHECK(number(row, "motor.acceleration") == 2);
        CHECK(number(row, "motor.load") == Approx(torque).margin(1e-11));
        CHECK(number(row, "motor.power") == Approx(torque * 2 * t).margin(1e-11));
    }
    const auto record = nlohmann::json::parse(read(in / "o/summary.json"));
    CHECK(record["analysis"] == "inverse");
    CHECK(record["drives"][0]["name"] == "motor");
    CHECK(record["drives"][0]["largest_load"] == Approx(1 + 9.81 * 0.5).epsilon(1e-12));
}

TEST_CASE("the load of a DP1 driver is the torque on its angle, whichever equation is active",
          "[run][kinematics]")
{
    const Scratch in;
    // The crank turns by 2 pi t; f = cos(angle) is replaced by its complement twice per turn.
    write(in / "m.json",
          model(bar, pivot + R"-(, {"name": "motor", "type": "DP1", "body_i": "ground", "body_j": "bar",
   "a_bar_i": [0, 1, 0], "a_bar_j": [0, "cos(1)", "sin(1)"], "f": "cos(2*pi*t + 1)"
})-"));
    for (const CsvRow& row : drives(in, {"m.json", "--fix-initial", "--interval", "0.01"})) {
        const double t = number(row, "t"), torque = 9.81 * 0.5 * std::cos(2 * M_PI * t);
        CHECK(number(row, "motor.load") == Approx(torque).margin(1e-9));
        CHECK(number(row, "motor.power") == Approx(2 * M_PI * torque).margin(1e-8));
    }
}

TEST_CASE("the loads of sampled motions of joints converge with the fourth power of the sampling",
          "[run][kinematics]")
{
    const Scratch in;
    // A carriage moves along z by s, and a bar on it turns by g about the x axis of the carriage.
    write(in / "m.json",
          model(R"({"name": "carriage", "mass": 2, "inertia": [1, 1, 1], "r": [0, 0, 0.3]},
  {"name": "bar", "mass": 1, "inertia": [0.25, 0.001, 0.25], "r": [0, 0.5, 0.3]})",
                R"({"name": "rail", "type": "translational", "body_i": "ground", "body_j": "carriage",
   "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
  {"name": "pivot", "type": "revolute", "body_i": "carriage", "body_j": "bar", "s_bar_q_j": [0, -0.5, 0],
   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]})"));
    double error[2] = {};
    for (const int k : {0, 1}) {
        std::ostringstream text;
        text.precision(17);
        text << "t,rail,pivot\n";
        const int n = k == 0 ? 25 : 50;
        for (int i = 0; i <= n; ++i) {
            const double t = i / double(n);
            text << t << ',' << 7 + 0.1 * std::sin(3 * t) << ',' << 0.4 * (1 - std::cos(2 * t)) << '\n';
        }
        write(in / "motion.csv", text.str());
        const auto rows = drives(in, {"m.json", "--motion", "motion.csv", "--interval", "0.02"});
        REQUIRE(rows.size() == 51);
        for (const CsvRow& row : rows) {
            const double t = number(row, "t"), s_2 = -0.9 * std::sin(3 * t), g = 0.4 * (1 - std::cos(2 * t)),
                         g_1 = 0.8 * std::sin(2 * t), g_2 = 1.6 * std::cos(2 * t), l = 0.5, G = 9.81;
            const double torque = (0.25 + l * l) * g_2 + l * std::cos(g) * (s_2 + G);
            const double force = 3 * (s_2 + G) + l * (g_2 * std::cos(g) - g_1 * g_1 * std::sin(g));
            error[k] = std::max({error[k], std::abs(number(row, "pivot drive.load") - torque),
                                 std::abs(number(row, "rail drive.load") - force)});
            CHECK(number(row, "rail drive.rate") == Approx(0.3 * std::cos(3 * t)).margin(1e-5));
        }
    }
    CHECK(error[1] < 1e-4);
    CHECK(error[0] / error[1] > 12);
}

TEST_CASE("the free motion of a mechanism needs no loads of drivers", "[run][kinematics]")
{
    const Scratch in;
    std::string free_bar = model(bar, pivot);
    free_bar.insert(free_bar.rfind('}'),
                    R"(, "outputs": [{"name": "swing", "type": "angle", "body_i": "ground",
  "body_j": "bar", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}])");
    write(in / "m.json", free_bar);
    REQUIRE(call(in, {"run", "m.json", "--integrator", "rA-dop853", "--rtol", "1e-12", "--interval", "2e-3",
                      "--output", "r"})
                .code == 0);
    std::ostringstream text;
    text << "t,pivot\n";
    for (const CsvRow& row : csv(in / "r/outputs.csv"))
        text << row.at("t") << ',' << row.at("swing.angle") << '\n';
    write(in / "motion.csv", text.str());
    for (const CsvRow& row : drives(in, {"m.json", "--motion", "motion.csv", "--interval", "0.01"}))
        CHECK(std::abs(number(row, "pivot drive.load")) < 1e-6);
}

TEST_CASE("a driver of a run can have samples in place of a formula", "[run][kinematics]")
{
    const Scratch in;
    write(in / "motion.csv", table("angle", 100, [](double t) { return t * t; }));
    write(in / "m.json", driven_bar());
    const std::vector<std::string> samples = {
        "--set", R"(/constraints/1/angle={"file": "motion.csv", "column": "angle"})"};
    const auto formula = drives(in, {"m.json"}), sampled = drives(in, with({"m.json"}, samples));
    REQUIRE(sampled.size() == formula.size());
    for (size_t k = 0; k < formula.size(); ++k)  // a quintic spline contains t^2
        CHECK(number(sampled[k], "motor.load") == Approx(number(formula[k], "motor.load")).margin(1e-8));
    // The canonical form has the numbers: it does not need the file.
    fs::remove(in / "motion.csv");
    CHECK(call(in, {"inverse", "o/model.json", "--no-plot", "--output", "again"}).code == 0);
    CHECK(csv(in / "again/drives.csv").size() == formula.size());
    check_refused(in, with(with({"run", "m.json", "--force", "--output", "r"}, samples), {}), 3,
                  "motion.csv");
    write(in / "motion.csv", table("angle", 100, [](double t) { return t * t; }));
    check_refused(in, with({"run", "m.json", "--end", "1.5", "--force", "--output", "r"}, samples), 2,
                  "run: --end must be at most 1 s, the last sample of the motion of 'motor', got 1.5");
}

TEST_CASE("wrong motions are refused with their place", "[run][kinematics]")
{
    const Scratch in;
    write(in / "m.json", model(bar, pivot));
    const auto refused = [&](const std::string& motion, const std::string& message) {
        write(in / "motion.csv", motion);
        check_refused(in, {"inverse", "m.json", "--motion", "motion.csv", "--output", "o", "--force"}, 3,
                      message);
    };
    refused("t,pivut\n0,0\n1,1\n",
            "motion.csv: the model has no joint or driver 'pivut'; did you mean 'pivot'?");
    refused("x,pivot\n0,0\n", "motion.csv: there is no column 't'");
    refused("t\n0\n", "there must be a column for a joint or a driver");
    refused("t,pivot\n0,0\n1,one\n", "motion.csv:3: pivot must be a number, got 'one'");
    refused("t,pivot\n0,0\n1,\n", "motion.csv: row 2: pivot must be a finite number, got nan");
    refused("t,pivot\n0,0\ninf,1\n", "motion.csv: row 2: t must be a finite number, got inf");
    refused("t,pivot\n0,0\n1,1\n", "a curve needs at least 6 samples; their number, got 2");
    refused("t,pivot\n0,0\n1,1\n2,1\n2,3\n4,4\n5,5\n", "sample 3: the times must be ascending");
    refused("t,pivot\n1,0\n2,1\n3,1\n4,3\n5,4\n6,5\n", "the samples must begin at t = 0 s or before, got 1");
    check_refused(
        in, {"inverse", "m.json", "--output", "o"}, 3,
        "inverse needs a model without degrees of freedom, got 1; prescribe more motions by drivers");
}
