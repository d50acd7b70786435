// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "studies/framework/problem.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

#include <sys/inotify.h>
#include <unistd.h>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

TEST_CASE("an invalid command line is reported in one line with exit code 2", "[studies][command line]")
{
    struct InvalidCall {
        std::vector<std::string> arguments;
        std::string expected;
    };
    const std::vector<InvalidCall> all = {
        {{}, "no command given"},
        {{"runn", "double_pendulum"}, "unknown command 'runn'; did you mean 'run'?"},
        {{"help", "chek"}, "unknown command 'chek'; did you mean 'check'?"},
        {{"new", "integrator", "rA-half-1"}, "new: there is an integrator 'rA-half-1'; choose another name"},
        {{"new", "granular-law", "hertz"}, "new: there is a normal law 'hertz'; choose another name"},
        {{"run"}, "MODEL is required"},
        {{"run", "double_pendulum", "more"}, "one argument too many: 'more'"},
        {{"run", "double_pendulum", "--stepp", "1e-3"}, "unknown option '--stepp'; did you mean '--step'?"},
        {{"run", "double_pendulum", "--step"}, "--step"},
        {{"run", "double_pendulum", "--step", "0"}, "--step: must be a positive, finite number, got '0'"},
        {{"run", "double_pendulum", "--step", "-1e-3"}, "got '-1e-3'"},
        {{"run", "double_pendulum", "--step", "inf"}, "got 'inf'"},
        {{"run", "double_pendulum", "--step", "1e-3s"}, "got '1e-3s'"},
        {{"run", "double_pendulum", "--step", "1e-3", "--step", "1e-4"}, "--step"},
        {{"run", "double_pendulum", "--step", "1e-30"}, "the number of steps must be at most 1e15"},
        {{"run", "double_pendulum", "--end", "-1"}, "--end"},
        {{"run", "double_pendulum", "--interval", "-1"}, "--interval"},
        {{"run", "double_pendulum", "--every", "1", "--interval", "1"},
         "--every is the old name of --interval"},
        {{"run", "double_pendulum", "--tolerance", "0"}, "--tolerance"},
        {{"run", "double_pendulum", "--threads", "0"}, "--threads"},
        {{"run", "double_pendulum", "--set", "gravity"}, "--set: must be /json/pointer=VALUE"},
        {{"run", "double_pendulum", "--force", "--resume"}, "exclude each other"},
        {{"run", "double_pendulum", "--integrator", "rA-half1"},
         "unknown integrator 'rA-half1'; did you mean 'rA-half-1'?"},
        {{"run", "double_pendulum", "--integrator", "rA-half-1,"}, "--integrator"},
        {{"run", "double_pendulum", "--integrator", "rA-half-1,rA-half-1"}, "each integrator once"},
        {{"study", "convergense"}, "unknown study 'convergense'; did you mean 'convergence'?"},
        {{"study", "convergence", "--steps", "1e-3,,1e-4"}, "--steps"},
        {{"study", "convergence", "--steps", "1e-3,1e-3"}, "--steps"},
        {{"study", "convergence", "--expect", "order"}, "--expect: must be KEY=VALUE"},
        {{"study", "convergence", "--expect", "order=2+-x"}, "--expect: must be KEY=VALUE"},
        {{"study", "convergence", "--jobs", "many"}, "--jobs"},
    };
    const Scratch in;
    for (const InvalidCall& invalid : all) check_refused(in, invalid.arguments, 2, invalid.expected);
}

TEST_CASE("the old option name --every is read with a notice", "[studies][command line]")
{
    const Scratch in;
    const auto run = [&](const char* option, const char* output) {
        return call(in, {"run", "double_pendulum", "--end", "0.1", option, "0.05", "--output", output});
    };
    const Ended by_interval = run("--interval", "a"), by_every = run("--every", "b");
    CHECK(by_interval.code == 0);
    CHECK(by_interval.err.empty());
    CHECK(by_every.code == 0);
    CHECK(by_every.err == "hilda: warning: --every was renamed to --interval; the old name is still read\n");
    CHECK(read(in / "a/trajectory.csv") == read(in / "b/trajectory.csv"));
}

TEST_CASE("the program lists models, integrators, studies and versions", "[studies][command line]")
{
    const Scratch in;
    const auto lists = [&](const std::vector<std::string>& arguments, const std::string& expected) {
        const Ended ended = call(in, arguments);
        CAPTURE(arguments, ended.err);
        CHECK(ended.code == 0);
        CHECK_THAT(ended.out, Contains(expected));
        CHECK(ended.err.empty());
    };
    lists({"--version"}, "hilda 0.");
    lists({"--version"}, "build: ");
    lists({"--version"}, "modules: grains, HDF5");
    lists({"--help"}, "integrators");
    lists({"help"}, "integrators");
    for (const char* command : {"run", "check", "models", "integrators", "study", "plot", "info"}) {
        lists({"help", command}, std::string("hilda ") + command);
        lists({command, "--help"}, std::string("hilda ") + command);
    }
    for (const lie::Scheme& scheme : lie::schemes()) {
        lists({"integrators"}, scheme.name);
        lists({"integrators", "--json"}, '"' + scheme.name + '"');
    }
    for (const studies::Problem& problem : studies::problems()) lists({"models"}, problem.name);
    lists({"study"}, "convergence");
    lists({"info"}, "libraries");
    lists({"info", "--json"}, "\"version\"");
}

TEST_CASE("a Python module in the current folder is not executed", "[studies][command line]")
{
    const Scratch in;
    write(in / "matplotlib.py", "open('executed', 'w')\n__version__ = '3.0'\n");
    CHECK(call(in, {"info"}).code == 0);
    CHECK_FALSE(fs::exists(in / "executed"));
}

TEST_CASE("missing models, files and devices exit with 3, 5 or 7", "[studies][command line]")
{
    const Scratch in;
    CHECK(call(in, {"run", "none.json"}).code == 3);
    CHECK(call(in, {"models", "none"}).code == 3);
    CHECK(call(in, {"plot", "none"}).code == 3);
    CHECK(call(in, {"granular", "heap"}).code == 3);
    CHECK_THAT(call(in, {"granular", "heap"}).err, Contains("heap: does not exist"));
    CHECK(call(in, {"granular", "heap", "--device", "cuda:99"}).code == 7);
    CHECK_THAT(call(in, {"granular", "--help"}).out, Contains("--checkpoint"));
    CHECK_THAT(call(in, {"run", "double_pendulun"}).err, Contains("double_pendulum"));
    CHECK(call(in, {"models", "double_pendulum", "--write", "none/mine.json"}).code == 5);
    CHECK(call(in, {"integrators"}, {.stdout_to = "/dev/full"}).code == 5);
}

TEST_CASE("missing Python is reported in one line and leaves the run successful", "[studies][command line]")
{
    const Scratch in;
    const Ended ended = call(in, {"run", "double_pendulum", "--end", "0.1", "--output", "a", "--plot"},
                             {.python = "/none/python3"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.err, StartsWith("hilda: warning: no figures: /none/python3 was not found"));
    CHECK(call(in, {"plot", "a"}, {.python = "/none/python3"}).code == 7);

    if (call(in, {"plot", "a"}).code != 0) {
        WARN("no matplotlib here: no figure was drawn");
        return;
    }
    CHECK(fs::file_size(in / "a/trajectory.png") > 10000);
}

// The kernel counts how often the file is opened.
TEST_CASE("a model file is read once per run, with --set and --normal-rows as well", "[studies][run]")
{
    const Scratch in;
    REQUIRE(call(in, {"models", "ball_in_bowl", "--write", "ball.json"}).code == 0);
    for (const char* command : {"run", "check"}) {
        const int watch = inotify_init1(IN_NONBLOCK);
        REQUIRE(inotify_add_watch(watch, (in / "ball.json").c_str(), IN_OPEN) >= 0);
        std::vector<std::string> arguments = {command,    "ball.json", "--normal-rows",
                                              "fixed-xy", "--set",     "/name=read once"};
        if (command == std::string("run"))
            arguments.insert(arguments.end(), {"--end", "1e-3", "--output", "a"});
        CHECK(call(in, arguments).code == 0);
        inotify_event events[8];
        CHECK(read(watch, events, sizeof events) == sizeof(inotify_event));  // one event
        close(watch);
    }
}
