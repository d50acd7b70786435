// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

std::vector<std::string> slider_crank_with(const std::string& integrator)
{
    return {"run",        "slider_crank", "--integrator", integrator,    "--end",   "1",
            "--interval", "1e-3",         "--reactions",  "--log-steps", "--euler", "zxz"};
}

}  // namespace

// The driver of the slider-crank passes four singular points per revolution, so that KLU chooses new pivots.
// The pivots are its only data outside the state.
TEST_CASE("an interrupted and killed run, resumed, gives the result of an uninterrupted run", "[run][resume]")
{
    const std::string integrator = GENERATE("rA-half-1", "rA-half-2", "rA-full-1");
    CAPTURE(integrator);
    const Scratch in;
    check_resumed(in, slider_crank_with(integrator),
                  {{SIGINT, 200}, {SIGKILL, 150}, {SIGKILL, 3}, {SIGTERM, 240}});
    const Scratch in_klu;
    check_resumed(in_klu, with(slider_crank_with(integrator), {"--linear-solver", "klu"}),
                  {{SIGINT, 200}, {SIGKILL, 150}, {SIGKILL, 3}, {SIGTERM, 240}});
    CHECK(summary(in_klu / "whole")["counters"]["factorizations"] >= 4);
}

TEST_CASE("an interruption writes a checkpoint without --checkpoint as well", "[run][resume]")
{
    const Scratch in;
    const std::vector<std::string> run = with(slider_crank_with("rA-half-1"), {"--quiet", "--output", "a"});
    // trajectory.csv is written for the first time when its rows fill a buffer.
    const Ended ended = call(in, run, {.end_at = {SIGTERM, 1, "a/trajectory.csv"}});
    REQUIRE(ended.code == 143);
    CHECK(summary(in / "a")["status"] == "interrupted");
    CHECK(summary(in / "a")["exit_code"] == 143);
    CHECK(summary(in / "a")["counters"]["steps"] > 100);
    CHECK(summary(in / "a")["counters"]["steps"] < 1000);
    REQUIRE(fs::exists(in / "a/checkpoint"));

    // a checkpoint of another run
    check_refused(
        in, with(run, {"--resume", "--tolerance", "1e-9"}), 2,
        "a: the checkpoint belongs to another run: it has --tolerance 1e-10; this run has --tolerance 1e-09; "
        "--force starts it again");
    check_refused(
        in, with(run, {"--resume", "--fix-initial", "--set", "/gravity/2=-1.62"}), 2,
        "another run: it has no --fix-initial, /gravity/2 -9.81; this run has --fix-initial, /gravity/2 "
        "-1.62; --force starts it again");

    // a damaged checkpoint without a previous one
    std::string bytes = read(in / "a/checkpoint");
    bytes[bytes.size() / 2] ^= 1;
    write(in / "a/checkpoint", bytes);
    check_refused(in, with(run, {"--resume"}), 5, "a/checkpoint: the checkpoint is damaged");

    // a damaged checkpoint with a valid previous one
    bytes[bytes.size() / 2] ^= 1;
    write(in / "a/checkpoint.1", bytes);
    const Ended fallen_back = call(in, with(run, {"--resume"}));
    CHECK(fallen_back.code == 0);
    CHECK_THAT(fallen_back.err, StartsWith("hilda: warning: a/checkpoint: the checkpoint is damaged"));
}

TEST_CASE("a run with --resume but without a checkpoint starts from the initial state", "[run][resume]")
{
    const Scratch in;
    const Ended ended = call(in, {"run", "double_pendulum", "--end", "0.1", "--resume", "--output", "a"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.err, Contains("starting from the initial state"));
}
