// SPDX-License-Identifier: GPL-3.0-or-later
/// --resume with a later --end.

#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// The directory follows.
const std::vector<std::string> slider_crank_into = {"run",     "slider_crank", "--interval", "1e-3",
                                                    "--quiet", "--log-steps",  "--output"};

}  // namespace

// The first end is between two output rows and between two frames: their last row and frame must disappear.
// The driver of the slider-crank makes the integrator choose new pivots. rA-half-1 and rA-half-2 have
// staggered velocities: their last node needs a further step.
TEST_CASE("a run extended by a later end gives the files of a run with this end", "[run][resume]")
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
    check_same_results(in / "parts", in / "whole");
    CHECK(summary(in / "parts")["provenance"]["resumed_at_step"] == 300);
}

TEST_CASE("an interrupted run can be continued to a later or an earlier end", "[run][resume]")
{
    const std::string end = GENERATE("0.7", "0.3");
    const Scratch in;
    REQUIRE(call(in, with(slider_crank_into, {"whole", "--end", end})).code == 0);
    // The checkpoint of the start, and then one of each step: the signal comes in step 200.
    const Ended first = call(in, with(slider_crank_into, {"parts", "--end", "0.5", "--checkpoint", "1e-9"}),
                             {.end_at = {SIGINT, 201, "parts/checkpoint.new.tmp"}});
    REQUIRE(first.code == 130);
    REQUIRE(summary(in / "parts")["counters"]["t"] == 0.2);

    check_refused(in, with(slider_crank_into, {"parts", "--resume", "--end", "1e-4"}), 2,
                  "--end must be after t = 0.2 s, which the run in parts has reached, got 0.0001");
    REQUIRE(call(in, with(slider_crank_into, {"parts", "--resume", "--end", end})).code == 0);
    check_same_results(in / "parts", in / "whole");
}

TEST_CASE("an extended run that is killed continues to the later end", "[run][resume]")
{
    const Scratch in;
    REQUIRE(call(in, with(slider_crank_into, {"parts", "--end", "0.05"})).code == 0);
    REQUIRE(fs::exists(in / "parts/checkpoint.end"));
    const auto complete = fs::file_size(in / "parts/trajectory.csv");
    const Ended killed =
        call(in, with(slider_crank_into, {"parts", "--end", "0.5", "--resume", "--checkpoint", "1e-9"}),
             {.end_at = {SIGKILL, 150, "parts/checkpoint.new.tmp"}});
    REQUIRE(killed.code == 137);
    CHECK_FALSE(fs::exists(in / "parts/summary.json"));
    CHECK(fs::file_size(in / "parts/trajectory.csv") > 2 * complete);
    REQUIRE(call(in, with(slider_crank_into, {"parts", "--resume"})).code == 0);  // the end of the checkpoint
    REQUIRE(call(in, with(slider_crank_into, {"whole", "--end", "0.5"})).code == 0);
    check_same_results(in / "parts", in / "whole");
}

TEST_CASE("without --end and --interval a resumed run keeps those of the run", "[run][resume]")
{
    const Scratch in;
    const std::vector<std::string> run = {"run", "double_pendulum", "--quiet", "--log-steps", "--output"};
    REQUIRE(call(in, with(run, {"a", "--end", "0.5"})).code == 0);  // rows each 5e-4 s, rounded up to 1e-3 s
    REQUIRE(call(in, with(run, {"a", "--end", "2.5", "--resume"})).code == 0);
    REQUIRE(call(in, with(run, {"b", "--end", "2.5", "--interval", "1e-3"})).code == 0);
    check_same_results(in / "a", in / "b");

    const std::string before = read(in / "a/trajectory.csv"), record = read(in / "a/summary.json");
    for (const std::vector<std::string>& end :
         std::vector<std::vector<std::string>>{{"a", "--resume"}, {"a", "--resume", "--end", "2.5"}}) {
        CHECK(call(in, with(run, end)).err.empty());
        const Ended complete = call(in, with({"run", "double_pendulum", "--log-steps", "--output"}, end));
        CHECK(complete.code == 0);
        CHECK(complete.out.empty());
        CHECK(
            complete.err ==
            "hilda: a: its run is complete, with the end 2.5 s; --end with a later time extends it, --force "
            "starts it again\n");
        const Ended json = call(in, with(with(run, end), {"--json"}));
        CHECK(json.code == 0);
        CHECK(nlohmann::ordered_json::parse(json.out) == nlohmann::ordered_json::parse(record));
    }
    for (const std::string end : {"2", "0"})
        check_refused(in, with(run, {"a", "--resume", "--end", end}), 2, "--end must be after t = 2.5 s");
    check_refused(in, with(run, {"a", "--resume", "--end", "3", "--interval", "0.1"}), 2,
                  "belongs to another run: it has --interval 0.001; this run has --interval 0.1; --force "
                  "starts it again");
    CHECK(read(in / "a/trajectory.csv") == before);
}

TEST_CASE("the option --resume with several integrators extends each of them", "[run][resume]")
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
    CHECK_THAT(again.err,
               Contains("a/rA-half-1: its run is complete") && Contains("a/rA-full-1: its run is complete"));
}
