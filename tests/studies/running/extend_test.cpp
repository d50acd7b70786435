// SPDX-License-Identifier: GPL-3.0-or-later
/// --resume with a later --end.

#include "tests/studies/program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using nlohmann::ordered_json;

namespace {

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more)
{
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

/// steps.csv without its last column, the wall time of a step
std::string without_times(const fs::path& file)
{
    std::istringstream in(read(file));
    std::string all;
    for (std::string line; std::getline(in, line);) all += line.substr(0, line.rfind(',')) + '\n';
    return all;
}

ordered_json summary(const fs::path& directory)
{
    return ordered_json::parse(read(directory / "summary.json"));
}

/// Compares all outputs of two runs but their times and command lines.
void check_same(const fs::path& a, const fs::path& b)
{
    CHECK(read(a / "trajectory.csv") == read(b / "trajectory.csv"));
    CHECK(without_times(a / "steps.csv") == without_times(b / "steps.csv"));
    for (const char* key : {"status", "model", "integrator", "counters", "invariants", "files"}) {
        CAPTURE(key);
        CHECK(summary(a)[key] == summary(b)[key]);
    }
    CHECK(fs::exists(a / "vtk") == fs::exists(b / "vtk"));
    if (!fs::exists(a / "vtk")) return;
    CHECK(read(a / "run.pvd") == read(b / "run.pvd"));
    size_t frames = 0;
    for (const auto& entry : fs::directory_iterator(b / "vtk")) {
        CHECK(read(a / "vtk" / entry.path().filename()) == read(entry.path()));
        ++frames;
    }
    CHECK(std::distance(fs::directory_iterator(a / "vtk"), fs::directory_iterator{}) ==
          static_cast<std::ptrdiff_t>(frames));
}

}  // namespace

// The first end is between two output rows and between two frames: their last row and frame must disappear.
// The driver of the slider-crank makes the integrator choose new pivots. rA-half-1 and rA-half-2 have
// staggered velocities: their last node needs a further step.
TEST_CASE("a run extended by a later end gives the files of a run with this end", "[studies][resume]")
{
    const std::string integrator =
                          GENERATE("rA-half-1", "rA-half-2", "rA-full-1", "rA-half-2-bdf2", "rA-rkmk-4"),
                      model = GENERATE("slider_crank", "rolling_ball", "ball_in_bowl");
    CAPTURE(integrator, model);
    const Scratch in;
    const bool drawn = model != "slider_crank";
    const auto run = [&](const std::string& directory, const std::vector<std::string>& more) {
        const Ended ended = call(
            in, with(with({"run", model, "--integrator", integrator, "--reactions", "--log-steps",
                           "--interval", "0.01", "--quiet", "--output", directory},
                          drawn ? std::vector<std::string>{"--vtk", "0.05"} : std::vector<std::string>{}),
                     more));
        CAPTURE(ended.err);
        REQUIRE(ended.code == 0);
    };
    run("whole", {"--end", "0.6"});
    run("parts", {"--end", "0.123"});
    run("parts", {"--end", "0.3", "--resume"});
    run("parts", {"--end", "0.6", "--resume"});
    check_same(in / "parts", in / "whole");
    CHECK(summary(in / "parts")["provenance"]["resumed_at_step"] == 300);
}

TEST_CASE("an interrupted run can be continued to a later or an earlier end", "[studies][resume]")
{
    const std::string end = GENERATE("1.5", "0.9");
    const Scratch in;
#ifdef NDEBUG
    const std::string step = "1e-5";
#else
    const std::string step = "1e-3";
#endif
    const std::vector<std::string> run = {"run",  "slider_crank", "--step",      step,      "--interval",
                                          "1e-3", "--quiet",      "--log-steps", "--output"};
    REQUIRE(call(in, with(run, {"whole", "--end", end})).code == 0);
    const Program first(in, with(run, {"parts", "--end", "1", "--checkpoint", "0.01"}));
    REQUIRE(appears(in / "parts/checkpoint.1"));
    first.send(SIGINT);
    REQUIRE(first.wait().code == 130);
    const double reached = summary(in / "parts")["counters"]["t"];
    REQUIRE(reached < 0.9);

    const Ended early = call(in, with(run, {"parts", "--resume", "--end", "1e-4"}));
    CHECK(early.code == 2);
    CHECK_THAT(early.err, Contains("--end must be after t = ") && Contains("got 0.0001"));
    REQUIRE(call(in, with(run, {"parts", "--resume", "--end", end})).code == 0);
    check_same(in / "parts", in / "whole");
}

TEST_CASE("an extended run that is killed continues to the later end", "[studies][resume]")
{
    const Scratch in;
    const std::vector<std::string> run = {"run",  "slider_crank", "--step",      "1e-5",    "--interval",
                                          "1e-3", "--quiet",      "--log-steps", "--output"};
    REQUIRE(call(in, with(run, {"parts", "--end", "0.01"})).code == 0);
    REQUIRE(fs::exists(in / "parts/checkpoint.end"));
    const Program killed(in, with(run, {"parts", "--end", "0.5", "--resume"}));
    REQUIRE(appears(in / "parts/checkpoint"));
    killed.send(SIGKILL);
    REQUIRE(killed.wait().code == 137);
    CHECK_FALSE(fs::exists(in / "parts/summary.json"));
    REQUIRE(call(in, with(run, {"parts", "--resume"})).code == 0);  // the end of the checkpoint
    REQUIRE(call(in, with(run, {"whole", "--end", "0.5"})).code == 0);
    check_same(in / "parts", in / "whole");
}

TEST_CASE("without --end and --interval a resumed run keeps those of the run", "[studies][resume]")
{
    const Scratch in;
    const std::vector<std::string> run = {"run", "double_pendulum", "--quiet", "--log-steps", "--output"};
    REQUIRE(call(in, with(run, {"a", "--end", "0.5"})).code == 0);  // rows each 5e-4 s, rounded up to 1e-3 s
    REQUIRE(call(in, with(run, {"a", "--end", "2.5", "--resume"})).code == 0);
    REQUIRE(call(in, with(run, {"b", "--end", "2.5", "--interval", "1e-3"})).code == 0);
    check_same(in / "a", in / "b");

    const Ended again = call(in, with(run, {"a", "--resume"}));
    CHECK(again.code == 2);
    CHECK_THAT(again.err,
               Contains("a: its run is complete, with the end 2.5 s; --end with a later time extends"));
    const std::string before = read(in / "a/trajectory.csv");
    for (const std::string end : {"2.5", "2", "0"}) {
        const Ended refused = call(in, with(run, {"a", "--resume", "--end", end}));
        CAPTURE(end, refused.err);
        CHECK(refused.code == 2);
        CHECK_THAT(refused.err, Contains(end == "2.5" ? "is complete" : "--end must be after t = 2.5 s"));
    }
    const Ended other = call(in, with(run, {"a", "--resume", "--end", "3", "--interval", "0.1"}));
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("belongs to another run") && Contains("interval 0.1"));
    CHECK(read(in / "a/trajectory.csv") == before);
}

TEST_CASE("the option --resume with several integrators extends each of them", "[studies][resume]")
{
    const Scratch in;
    const auto run = [&](const std::string& integrators, const std::vector<std::string>& more) {
        return call(in, with({"run", "double_pendulum", "--integrator", integrators, "--output", "a"}, more));
    };
    REQUIRE(run("rA-half-1,rA-full-1", {"--end", "0.1"}).code == 0);
    const Ended both = run("rA-half-1,rA-full-1", {"--end", "0.2", "--resume"});
    CHECK(both.code == 0);
    CHECK(summary(in / "a/rA-half-1")["counters"]["steps"] == 200);
    CHECK(summary(in / "a/rA-full-1")["counters"]["steps"] == 200);
    const Ended again = run("rA-half-1,rA-full-1", {"--end", "0.2", "--resume"});
    CHECK(again.code == 0);
    CHECK_THAT(again.err, Contains("a/rA-full-1: its run is complete") && Contains("; skipped"));
}
