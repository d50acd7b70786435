// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using nlohmann::ordered_json;

namespace {

// The run must be long enough to be interrupted. A step takes a hundred times longer in a debug build.
#ifdef NDEBUG
constexpr const char* fine_step = "1e-5";
#else
constexpr const char* fine_step = "1e-3";
#endif

/// About 100 000 steps, half a second
std::vector<std::string> long_run(const std::string& integrator, const std::string& directory)
{
    return {"run",     "slider_crank", "--integrator", integrator,    "--step",      fine_step, "--end",
            "1",       "--interval",   "1e-3",         "--reactions", "--log-steps", "--euler", "zxz",
            "--quiet", "--output",     directory};
}

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

ordered_json counters_and_invariants(const fs::path& directory)
{
    const ordered_json summary = ordered_json::parse(read(directory / "summary.json"));
    return {summary["status"], summary["counters"], summary["invariants"]};
}

}  // namespace

// The driver of the slider-crank passes four singular points per revolution, so that the integrator chooses
// new pivots. The pivots are its only data outside the state.
TEST_CASE("an interrupted and killed run, resumed, gives the result of an uninterrupted run",
          "[studies][resume]")
{
    const std::string integrator = GENERATE("rA-half-1", "rA-half-2", "rA-full-1");
    CAPTURE(integrator);
    const Scratch in;
    REQUIRE(call(in, long_run(integrator, "whole")).code == 0);

    const std::vector<std::string> parts = with(long_run(integrator, "parts"), {"--checkpoint", "0.02"});
    const Program first(in, parts);
    REQUIRE(appears(in / "parts/checkpoint.1"));
    first.send(SIGINT);
    const Ended interrupted = first.wait();
    CHECK(interrupted.code == 130);
    CHECK(ordered_json::parse(read(in / "parts/summary.json"))["status"] == "interrupted");
    CHECK(ordered_json::parse(read(in / "parts/summary.json"))["exit_code"] == 130);

    int code = 137;
    for (int k = 0; k < 2 && code == 137; ++k) {  // on a fast machine the run may end before the kill
        const Program killed(in, with(parts, {"--resume"}));
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        killed.send(SIGKILL);
        code = killed.wait().code;
    }
    if (code == 137) code = call(in, with(parts, {"--resume"})).code;
    REQUIRE(code == 0);
    CHECK(read(in / "parts/trajectory.csv") == read(in / "whole/trajectory.csv"));
    CHECK(read(in / "parts/euler.csv") == read(in / "whole/euler.csv"));
    CHECK(without_times(in / "parts/steps.csv") == without_times(in / "whole/steps.csv"));
    CHECK(counters_and_invariants(in / "parts") == counters_and_invariants(in / "whole"));
    CHECK_FALSE(fs::exists(in / "parts/checkpoint"));
}

TEST_CASE("an interruption writes a checkpoint without --checkpoint as well", "[studies][resume]")
{
    const Scratch in;
    const Program program(in, long_run("rA-half-1", "a"));
    REQUIRE(appears(in / "a/model.json"));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    program.send(SIGTERM);
    CHECK(program.wait().code == 143);
    REQUIRE(fs::exists(in / "a/checkpoint"));

    // a checkpoint of another run
    const Ended other = call(in, with(long_run("rA-half-1", "a"), {"--resume", "--tolerance", "1e-9"}));
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("belongs to another run"));

    // a damaged checkpoint without a previous one
    std::string bytes = read(in / "a/checkpoint");
    bytes[bytes.size() / 2] ^= 1;
    write(in / "a/checkpoint", bytes);
    const Ended damaged = call(in, with(long_run("rA-half-1", "a"), {"--resume"}));
    CHECK(damaged.code == 5);
    CHECK_THAT(damaged.err, StartsWith("hilda: error: a/checkpoint: the checkpoint is damaged"));

    // a damaged checkpoint with a valid previous one
    bytes[bytes.size() / 2] ^= 1;
    write(in / "a/checkpoint.1", bytes);
    const Ended fallen_back = call(in, with(long_run("rA-half-1", "a"), {"--resume"}));
    CHECK(fallen_back.code == 0);
    CHECK_THAT(fallen_back.err, StartsWith("hilda: warning: a/checkpoint: the checkpoint is damaged"));
}

TEST_CASE("a run with --resume but without a checkpoint starts from the initial state", "[studies][resume]")
{
    const Scratch in;
    const Ended ended = call(in, {"run", "double_pendulum", "--end", "0.1", "--resume", "--output", "a"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.err, Contains("starting from the initial state"));
}
