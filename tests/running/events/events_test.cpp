// SPDX-License-Identifier: GPL-3.0-or-later
/// "events" of a model file in hilda run.
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// A ball that is thrown upwards from z = 1 m with 2 m/s
std::string ball(const std::string& events)
{
    return R"({"hilda_model": 1, "name": "ball", "end": 1, "gravity": [0, 0, -9.81],
 "bodies": [{"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [0, 0, 1], "r_dot": [0, 0, 2]}],
 "outputs": [{"name": "height", "type": "expression", "value": "ball.rz - 0.5"}],
 "events": [)" +
           events + "]}";
}

/// A pendulum with a damper about its hinge; its bar is vertical twice in a period.
std::string swing()
{
    std::string model = pendulum("", R"({"name": "damper", "type": "torsion-spring", "body_i": "ground",
 "body_j": "bar", "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0], "stiffness": 0, "damping": 0.5, "free_angle": 0})");
    model.insert(model.rfind('}'), R"(, "events": [
  {"name": "lowest", "value": "bar.ry"},
  {"name": "to the right", "value": "bar.ry", "direction": "rising"},
  {"name": "fast", "value": "bar.wx^2 - 4", "direction": "rising"}])");
    return model;
}

std::vector<CsvRow> events(const fs::path& directory) { return csv(directory / "events.csv"); }

}  // namespace

TEST_CASE("an event of a falling body is at the time of the closed form", "[run][events]")
{
    const Scratch in;
    write(in / "ball.json",
          ball(R"({"name": "ground", "value": "ball.rz", "direction": "falling", "action": "stop"},
                  {"name": "top", "value": "ball.vz"}, {"name": "half", "value": "height"},
                  {"name": "later", "value": "t - 0.9"})"));
    const double g = 9.81, end = (2 + std::sqrt(4 + 2 * g)) / g, half = (2 + std::sqrt(4 + g)) / g;
    for (const std::vector<std::string>& scheme :
         {std::vector<std::string>{"--integrator", "rA-rattle", "--step", "7e-3"},
          {"--integrator", "rA-half-1-kick", "--step", "7e-3"},
          {"--integrator", "rA-rkmk-4", "--step", "7e-3"},
          {"--integrator", "rA-genalpha", "--step", "7e-3"},
          {"--integrator", "rA-dp-5"},
          {"--integrator", "rA-dop853", "--interval", "0.3"}}) {
        CAPTURE(scheme[1]);
        const Ended run = call(in, with(with({"run", "ball.json", "--force", "--output", "o"}, scheme), {}));
        CAPTURE(run.err);
        REQUIRE(run.code == 0);
        CHECK_THAT(run.out, Contains("ground: 1, the last at t = 0.69") && Contains("which ends the run"));
        const auto rows = events(in / "o");
        REQUIRE(rows.size() == 3);
        CHECK(number(rows[0], "event") == 1);
        CHECK(number(rows[0], "direction") == -1);
        CHECK(number(rows[0], "t") == Approx(2 / g).margin(1e-12));
        CHECK(number(rows[1], "t") == Approx(half).margin(1e-12));
        CHECK(number(rows[2], "t") == Approx(end).margin(1e-12));
        CHECK(std::abs(number(rows[2], "ball.rz")) < 1e-12);
        CHECK(number(rows[2], "ball.vz") == Approx(2 - g * end).margin(1e-10));
        // The state at the event is the last row.
        const auto trajectory = csv(in / "o/trajectory.csv");
        CHECK(trajectory.back().at("t") == rows[2].at("t"));
        CHECK(trajectory.back().at("ball.rz") == rows[2].at("ball.rz"));
        const auto record = summary(in / "o");
        CHECK(record["status"] == "ok");
        CHECK(record["stopped_by"] == "ground");
        CHECK(record["counters"]["t"] == number(rows[2], "t"));
        CHECK(record["events"][3] == nlohmann::ordered_json({{"name", "later"}, {"count", 0}}));
    }
}

TEST_CASE("the times of events have the order of the scheme", "[run][events]")
{
    const Scratch in;
    write(in / "swing.json", swing());
    const auto times = [&](const std::vector<std::string>& scheme) {
        REQUIRE(call(in, with({"run", "swing.json", "--end", "4", "--quiet", "--no-plot", "--force",
                               "--output", "o"},
                              scheme))
                    .code == 0);
        std::vector<double> all;
        for (const CsvRow& row : events(in / "o")) all.push_back(number(row, "t"));
        return all;
    };
    const std::vector<double> exact = times({"--integrator", "rA-dop853", "--rtol", "1e-13"});
    REQUIRE(exact.size() > 6);
    // With adaptive steps they do not depend on the output rows.
    const std::vector<double> other =
        times({"--integrator", "rA-dop853", "--rtol", "1e-13", "--interval", "0.05"});
    REQUIRE(other.size() == exact.size());
    for (size_t k = 0; k < exact.size(); ++k) CHECK(other[k] == Approx(exact[k]).margin(1e-10));
    for (const auto& [scheme, order] : {std::pair("rA-half-1-kick", 2), {"rA-rattle", 2}, {"rA-rkmk-4", 4}}) {
        CAPTURE(scheme);
        double error[2] = {};
        for (const int k : {0, 1}) {
            const std::vector<double> all =
                times({"--integrator", scheme, "--step", k == 0 ? "1e-2" : "5e-3", "--tolerance", "1e-13"});
            REQUIRE(all.size() == exact.size());
            for (size_t n = 0; n < all.size(); ++n)
                error[k] = std::max(error[k], std::abs(all[n] - exact[n]));
        }
        CHECK(std::log2(error[0] / error[1]) == Approx(order).margin(0.25));
    }
}

TEST_CASE("events that are flat, steep or jump are at the time of the closed form, and a touch is one event",
          "[run][events]")
{
    const Scratch in;
    write(in / "flat.json",
          R"json({"hilda_model": 1, "name": "ball", "end": 1,
 "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 1]}],
 "events": [{"name": "line", "value": "b.rz"}, {"name": "cube", "value": "b.rz^3"},
            {"name": "one side", "value": "b.rz*exp(-40*b.rz)"}, {"name": "jump", "value": "if(t-0.5537,1,-1e-9)"},
            {"name": "touch", "value": "(t-0.75)^2"}, {"name": "node", "value": "t-0.25"},
            {"name": "near", "value": "t-0.25-1e-13"}]})json");
    for (const std::vector<std::string>& scheme : {std::vector<std::string>{"--step", "1e-3"},
                                                   {"--step", "0.25"},
                                                   {"--integrator", "rA-dop853", "--interval", "0.25"}}) {
        CAPTURE(scheme.back());
        const Ended run = call(in, with({"run", "flat.json", "--force", "--output", "o"}, scheme));
        CAPTURE(run.err);
        REQUIRE(run.code == 0);
        const double fall = std::sqrt(2 / 9.81),
                     expected[] = {fall, fall, fall, 0.5537, 0.75, 0.25, 0.25 + 1e-13};
        const auto rows = events(in / "o");
        CHECK(rows.size() == std::size(expected));
        for (const CsvRow& row : rows)
            CHECK(number(row, "t") ==
                  Approx(expected[static_cast<size_t>(number(row, "event"))]).margin(2e-15));
    }
}

TEST_CASE("directions select zeros; a resumed run has the events of an uninterrupted one", "[run][events]")
{
    const Scratch in;
    write(in / "swing.json", swing());
    for (const std::string scheme : {"rA-half-1-kick", "rA-dp-5"}) {
        CAPTURE(scheme);
        const std::vector<std::string> run = {"run",        "swing.json", "--quiet",      "--no-plot",
                                              "--interval", "0.01",       "--integrator", scheme};
        REQUIRE(call(in, with(run, {"--end", "4", "--force", "--output", "whole"})).code == 0);
        REQUIRE(call(in, with(run, {"--end", "1.7", "--force", "--output", "parts"})).code == 0);
        REQUIRE(call(in, with(run, {"--end", "4", "--resume", "--output", "parts"})).code == 0);
        CHECK(read(in / "whole/events.csv") == read(in / "parts/events.csv"));
        CHECK(summary(in / "whole")["events"] == summary(in / "parts")["events"]);
        long both = 0, up = 0;
        for (const CsvRow& row : events(in / "whole")) {
            both += number(row, "event") == 0 ? 1 : 0;
            if (number(row, "event") != 1) continue;
            ++up;
            CHECK(number(row, "direction") == 1);
        }
        CHECK(both >= 2);
        CHECK(std::abs(both - 2 * up) <= 1);
        CHECK(summary(in / "whole")["events"][0]["count"] == both);
    }
}

TEST_CASE("events that cannot be found are refused", "[run][events]")
{
    const Scratch in;
    const auto refused = [&](const std::string& event, int code, const std::string& message,
                             const std::vector<std::string>& more = {}) {
        write(in / "ball.json", ball(event));
        check_refused(in, with({"run", "ball.json", "--force", "--output", "o"}, more), code, message);
    };
    refused(R"({"value": "bal.rz"})", 3, "ball.json:4:23 (/events/0/value): unknown");
    refused(R"({"value": "ball.rz", "direction": "up"})", 3,
            "(/events/0/direction): unknown direction \"up\"; allowed: both");
    refused(R"({"value": "ball.rz", "action": "end"})", 3, "(/events/0/action)");
    refused(R"({"name": "a", "value": "ball.rz"}, {"name": "a", "value": "ball.rz"})", 3, "already used");
    refused(R"({"name": "height", "value": "ball.rz"})", 3, "the column 'height' exists already");
    refused(R"({"name": "a"})", 3, "value");
    refused(R"({"name": "a", "value": "ball.rz"})", 2, "stores past steps outside the state; events need",
            {"--integrator", "ida-rp-index1"});
    refused(R"({"name": "a", "value": "ball.rz"})", 2, "--error is for models without events", {"--error"});
    write(in / "ball.json", ball(R"-({"name": "a", "value": "sqrt(-1 - ball.rz^2)"})-"));
    // not a number at the start, and later
    write(in / "ball.json", ball(R"-({"name": "a", "value": "sqrt(0.9 - ball.rz) + 1"})-"));
    const Ended some = call(in, {"run", "ball.json", "--force", "--output", "o"});
    CHECK(some.code == 0);
    CHECK_THAT(some.err, Contains("the formula of the event 'a' is not a number at t = 0 s"));
    write(in / "ball.json", ball(R"-({"name": "a", "value": "sqrt(-1 - ball.rz^2)"})-"));
    const Ended never = call(in, {"run", "ball.json", "--force", "--output", "o"});
    CHECK(never.code == 4);
    CHECK_THAT(never.err,
               Contains("error[event_not_finite]: ball.json:4:36 (/events/0/value): the formula of the "
                        "event 'a' is not finite at any node"));
}
