// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// A ball thrown upwards with 10 m/s from the origin
const char* const thrown = R"({"hilda_model": 1, "name": "thrown", "gravity": [0, 0, -10], "end": 1,
 "bodies": [{"name": "ball", "mass": 2, "inertia": [1, 1, 1], "r": [0, 0, 0], "r_dot": [0, 0, 10]}],
 "constraints": []}
)";

}  // namespace

// z(t) = v t - g t²/2: exact for a scheme of second order. E - E_0 = 0.
TEST_CASE("a sweep tabulates the end state of each combination", "[studies][sweep]")
{
    const Scratch in;
    write(in / "thrown.json", thrown);
    const Ended ended =
        call(in, {"study", "sweep", "thrown.json", "--sweep", "/bodies/0/r_dot=[0,0,5],[0,0,10]", "--sweep",
                  "/gravity/2=-10:0:3", "--integrator", "rA-half-2", "--steps", "0.01", "--output", "a",
                  "--no-plot", "--jobs", "2"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const std::vector<CsvRow> rows = csv(in / "a/study.csv");
    REQUIRE(rows.size() == 6);
    for (size_t k = 0; k < 6; ++k) {
        const double v = k < 3 ? 5 : 10, g = 10. - 5. * static_cast<double>(k % 3);
        CAPTURE(k, v, g);
        CHECK(rows[k].at("run") == std::to_string(k + 1));
        CHECK(rows[k].at("/bodies/0/r_dot") == (k < 3 ? "[0,0,5]" : "[0,0,10]"));
        CHECK(number(rows[k], "/gravity/2") == -g);
        CHECK(number(rows[k], "t") == 1);
        CHECK(number(rows[k], "observable_end") == Approx(v - g / 2).margin(1e-9));
        CHECK(number(rows[k], "rz") == number(rows[k], "observable_end"));
        CHECK(number(rows[k], "vz") == Approx(v - g).margin(1e-9));
        CHECK(number(rows[k], "observable_max") == Approx(v > g ? v - g / 2 : v * v / 2 / g).margin(1e-9));
        CHECK(number(rows[k], "observable_min") == Approx(std::min(0., v - g / 2)).margin(1e-9));
        CHECK(number(rows[k], "energy_start") == Approx(v * v));
        CHECK(number(rows[k], "energy_drift") < 1e-9);
        CHECK(number(rows[k], "max_force") == 0);
        CHECK(rows[k].at("status") == "ok");
    }
    const auto record = nlohmann::json::parse(read(in / "a/study.json"));
    CHECK(record["runs"].size() == 6);
    CHECK(record["sweep"][1]["pointer"] == "/gravity/2");
    CHECK(record["observable"] == "ball.rz");
    CHECK_FALSE(fs::exists(in / "a/runs"));
}

TEST_CASE("a row of a sweep is the run with these values", "[studies][sweep]")
{
    const Scratch in;
    REQUIRE(call(in, {"study",
                      "sweep",
                      "slider_crank",
                      "--sweep",
                      "/gravity/2=-9.81,-5",
                      "--integrator",
                      "rA-half-1,rA-full-1",
                      "--steps",
                      "1e-3,2e-3",
                      "--end",
                      "0.5",
                      "--keep",
                      "--output",
                      "a",
                      "--quiet",
                      "--no-plot",
                      "--set",
                      "/name=crank",
                      "--observable",
                      "slider.vx"})
                .code == 0);
    const std::vector<CsvRow> rows = csv(in / "a/study.csv");
    REQUIRE(rows.size() == 8);
    for (const size_t k : {0u, 3u, 6u}) {
        const CsvRow& row = rows[k];
        REQUIRE(call(in, {"run", "slider_crank", "--set", "/name=crank", "--set",
                          "/gravity/2=" + row.at("/gravity/2"), "--integrator", row.at("integrator"),
                          "--step", row.at("h"), "--end", "0.5", "--quiet", "--force", "--output", "b"})
                    .code == 0);
        const std::string kept = "a/runs/000" + row.at("run");
        CHECK(read(in / kept / "trajectory.csv") == read(in / "b/trajectory.csv"));
        CHECK(read(in / kept / "model.json") == read(in / "b/model.json"));
        const auto summary = nlohmann::json::parse(read(in / "b/summary.json"));
        CHECK(number(row, "energy_drift") == summary["invariants"]["energy_drift"]);
        CHECK(number(row, "constraint_norm") == summary["invariants"]["constraint_norm"]);
        CHECK(number(row, "steps") == summary["counters"]["steps"]);
        CHECK(number(row, "observable_end") == number(csv(in / "b/trajectory.csv").back(), "slider.vx"));
    }
    // A smaller sweep in the same directory leaves no runs of the larger one.
    REQUIRE(call(in, {"study", "sweep", "slider_crank", "--sweep", "/gravity/2=-9.81", "--end", "0.1",
                      "--keep", "--output", "a", "--quiet", "--no-plot", "--force"})
                .code == 0);
    CHECK(std::distance(fs::directory_iterator(in / "a/runs"), fs::directory_iterator{}) == 1);
}

TEST_CASE("a wrong value of a sweep is refused before the first run", "[studies][sweep]")
{
    const Scratch in;
    write(in / "thrown.json", thrown);
    const auto refused = [&](int code, const std::vector<std::string>& more, const std::string& message) {
        check_refused(in, with({"study", "sweep", "thrown.json", "--output", "a"}, more), code, message);
    };
    refused(3, {"--sweep", "/bodies/0/mas=1,2"}, "did you mean 'mass'");
    refused(3, {"--sweep", "/bodies/1/mass=1,2"}, "there is no \"1\"");
    refused(3, {"--sweep", "/bodies/0/mass=1,2,-3"}, "(from --sweep /bodies/0/mass=-3)");
    refused(3, {"--sweep", "/bodies/0/mass=1,heavy"}, "thrown");
    refused(2, {"--sweep", "/bodies/0/mass=1,"}, "without empty values");
    refused(2, {"--sweep", "/bodies/0/mass=1", "--set", "/bodies/0/mass=2"}, "change the same entry");
    refused(2, {"--sweep", "/bodies/0/mass=1", "--observable", "bal.rz"},
            "the model has no column 'bal.rz'; did you mean 'ball.rz'");
    refused(2, {"--sweep", "/bodies/0/mass=1", "--observable", "ball.rq"}, "did you mean");
    refused(2, {"--sweep", "/bodies/0/mass=1", "--observable", "ball"}, "the model has no column 'ball'");
    refused(2, {"--sweep", "/bodies/0/mass=1", "--steps", "0.3"}, "must divide the end");
    refused(2, {}, "needs --sweep");
    check_refused(in, {"study", "energy", "--sweep", "/a=1"}, 2, "--sweep is for sweep");
    check_refused(in, {"study", "sweep", "thrown.json", "--sweep", "/end=1,2", "--keep", "--json"}, 2,
                  "--keep");
}

// Newton's method diverges in the first step of the second run: it has no node.
TEST_CASE("a failed run of a sweep is a row with its status, and the exit code is 4", "[studies][sweep]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "sweep", "double_pendulum", "--sweep", "/gravity/2=-9.81,-1e12",
                                  "--end", "0.1", "--output", "a", "--no-plot"});
    CAPTURE(ended.err, ended.out);
    CHECK(ended.code == 4);
    CHECK_THAT(ended.err, Contains("1 of 2 runs failed") && Contains("with /gravity/2=-1e12"));
    const std::vector<CsvRow> rows = csv(in / "a/study.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("status") == "ok");
    CHECK(number(rows[0], "t") == Approx(0.1));
    CHECK(rows[1].at("status") == "newton_diverged");
    CHECK(rows[1].at("observable_end").empty());
}

TEST_CASE("an interrupted sweep, resumed, gives the table of an uninterrupted sweep",
          "[studies][sweep][resume]")
{
    const Scratch in;
    const std::vector<std::string> study = {
        "study",     "sweep",   "slider_crank", "--sweep", "/gravity/2=-10:0:12",
        "--end",     "0.5",     "--steps",      "1e-4",    "--keep",
        "--no-plot", "--quiet", "--jobs",       "2",       "--output"};
    REQUIRE(call(in, with(study, {"whole"})).code == 0);
    // The first write to study.part is the record of the options.
    const Ended part = call(in, with(study, {"parts"}), {.end_at = {SIGINT, 5, "parts/study.part"}});
    CHECK(part.code == 130);
    CHECK_THAT(part.err, Contains("--resume continues"));
    CHECK_FALSE(fs::exists(in / "parts/study.csv"));
    check_refused(in, with(study, {"parts", "--resume", "--sweep", "/gravity/1=0,1"}), 2,
                  "--resume needs the same");
    REQUIRE(call(in, with(study, {"parts", "--resume"})).code == 0);
    std::vector<CsvRow> a = csv(in / "parts/study.csv"), b = csv(in / "whole/study.csv");
    for (auto* rows : {&a, &b})
        for (CsvRow& row : *rows) row.erase("cpu_seconds");
    CHECK(a == b);
    CHECK(a.size() == 12);
    for (const char* run : {"0001", "0002", "0012"})
        CHECK(read(in / "parts/runs" / run / "trajectory.csv") ==
              read(in / "whole/runs" / run / "trajectory.csv"));
}

TEST_CASE("the observable of a sweep may be any column of the run", "[studies][sweep]")
{
    const Scratch in;
    const std::string outputs =
        R"("outputs": [{"name": "twice", "type": "expression", "value": "2*ball.vz", "unit": "m/s"}], )";
    std::string model = thrown;
    model.insert(model.find('{') + 1, outputs);
    write(in / "thrown.json", model);
    const auto swept = [&](const std::string& observable) {
        REQUIRE(call(in, {"study", "sweep", "thrown.json", "--sweep", "/gravity/2=-10,-5", "--observable",
                          observable, "--no-plot", "--force"})
                    .code == 0);
        return csv(in / "out/sweep/study.csv");
    };
    for (const CsvRow& row : swept("twice")) CHECK(number(row, "observable_end") == 2 * number(row, "vz"));
    model.replace(model.find("\"bodies\": ["), 11,
                  "\"bodies\": [{\"name\": \"first\", \"mass\": 1, \"inertia\": [1, 1, 1], "
                  "\"r\": [7, 0, 0]}, ");
    write(in / "thrown.json", model);
    for (const CsvRow& row : swept("first.rx")) CHECK(number(row, "rx") == 7);  // not of the last body
    for (const CsvRow& row : swept("energy"))
        CHECK(number(row, "observable_end") == number(row, "energy_end"));
    for (const CsvRow& row : swept("constraint_norm"))
        CHECK(number(row, "observable_max") == number(row, "constraint_norm"));
}
