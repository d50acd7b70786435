// SPDX-License-Identifier: GPL-3.0-or-later
/// The steps that a force stands, and that `hilda run` refuses beyond.

#include "studies/exit_codes.hpp"
#include "studies/running/single_run.hpp"
#include "tests/studies/program.hpp"
#include "tests/support/bristle_contacts.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using studies::SingleRun;

namespace {

/// A body on a bristle of 18.5 kN/m, which is stable up to 2/sqrt(18500) s = 14.704 ms
struct Brushed {
    const tests::BristleContacts reader;
    const tests::Scratch in;
    studies::RunOptions options;

    Brushed()
    {
        tests::write(in / "m.json",
                     R"({"hilda_model": 1, "name": "m", "end": 0.3,
 "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 1]}],
 "contacts": [{"name": "brush", "body_i": "ground", "body_j": "bar", "stiffness": 18500}]})");
        options.model = (in / "m.json").string();
        options.quiet = true;
    }
    studies::Result run(const std::string& scheme = "rA-half-1") const
    {
        return SingleRun(options, lie::scheme(scheme), directory()).go();
    }
    std::string directory() const { return (in / "out").string(); }
};

}  // namespace

TEST_CASE("a step above what a force stands is refused, by name and before anything is written",
          "[studies][stable_step]")
{
    Brushed m;
    m.options.step = 0.015;
    CHECK_THROWS_AS(m.run(), studies::UsageError);
    CHECK_THROWS_WITH(m.run(),
                      "run: the step 0.015 s is above 0.0147 s, the largest at which bristle 'brush' "
                      "is stable with an explicit step; --force overrides");
    CHECK_FALSE(tests::fs::exists(m.directory()));

    m.options.force = true;
    CHECK(m.run().step == 0.015);
    m.options.force = false;
    m.options.step = 0.0147;  // what the message says
    CHECK(m.run().status == "ok");
    m.options.step.reset();
    CHECK(m.run().status == "ok");
}

TEST_CASE("a scheme that chooses its own steps is refused where a force remembers numbers",
          "[studies][stable_step]")
{
    const Brushed m;
    CHECK_THROWS_WITH(m.run("ida-rp"),
                      "run: ida-rp chooses its own steps; bristle 'brush' remembers numbers "
                      "from step to step and needs a fixed-step scheme");
    CHECK_FALSE(tests::fs::exists(m.directory()));
}

TEST_CASE("a run with --force that was killed is gone on with, and ends as one that was left alone",
          "[studies][stable_step][resume]")
{
    Brushed m;
    m.options.step = 0.016;
    m.options.end = 30;
    m.options.force = true;
    REQUIRE(m.run().status == "ok");
    const std::string whole = tests::read(m.in / "out/trajectory.csv");

    m.options.checkpoint = 1e-9;  // at every step
    tests::fs::remove_all(m.directory());
    const pid_t child = fork();
    if (child == 0) {
        try {
            m.run();
        } catch (...) {
        }
        _exit(0);
    }
    REQUIRE(child > 0);
    CHECK(tests::appears(m.in / "out/checkpoint.1"));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // by then it is not that of the start
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);

    m.options.force = false;
    m.options.resume = true;
    m.options.checkpoint = 0;
    const studies::Result resumed = m.run();
    CHECK(resumed.status == "ok");
    CHECK(resumed.resumed_at > 0);
    CHECK(tests::read(m.in / "out/trajectory.csv") == whole);
}

TEST_CASE("a study refuses steps that a force does not stand", "[studies][stable-step]")
{
    const tests::Scratch in;
    const tests::Ended ended = tests::call(
        in, {"study", "convergence", "--problem", "rolling_ball", "--steps", "2e-2,1e-2", "--no-plot"});
    CHECK(ended.code == 2);
    CHECK(ended.err.find("rolling_ball: the step 0.02 s is above") != std::string::npos);
    CHECK(ended.err.find("--steps sets others") != std::string::npos);
}
