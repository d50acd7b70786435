// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/repeating/rerun.hpp"

#include "io/error.hpp"
#include "io/provenance.hpp"
#include "studies/program/repeating/compare_results.hpp"
#include "tests/support/program/program.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("a command line that was quoted for the shell has the same words")
{
    std::vector<std::string> words = {"hilda", "run", "a b.json", "--set", "/bodies/0/r/0=\"3*w\"",
                                      "it's",  "x\\y"};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    CHECK(studies::shell_words(io::shell_quoted(static_cast<int>(argv.size()), argv.data())) == words);
    CHECK_THROWS_AS(studies::shell_words("hilda 'run"), io::InvalidInput);
}

TEST_CASE("hilda rerun repeats a run and finds what differs")
{
    const Scratch in;
    REQUIRE(
        call(in, {"run", "double_pendulum", "--end", "0.05", "--set", "/bodies/0/mass=300", "--output", "a"})
            .code == 0);
    const Ended same = call(in, {"rerun", "a"});
    INFO(same.out << same.err);
    CHECK(same.code == 0);
    CHECK_THAT(same.out, Contains("trajectory.csv: identical") && Contains("model.json: identical") &&
                             Contains("--output a-again"));
    CHECK_THAT(call(in, {"rerun", "a"}).err, Contains("a-again: the directory is not empty"));

    std::string table = read(in / "a/trajectory.csv");
    const size_t last = table.rfind(',');
    table.replace(last, std::string::npos, ",12\n");
    write(in / "a/trajectory.csv", table);
    const Ended changed = call(in, {"rerun", "a", "--output", "b"});
    CHECK(changed.code == 6);
    CHECK_THAT(changed.out, Contains("largest difference") && Contains("column constraint_norm in row 51"));
    CHECK(call(in, {"rerun", "a", "--output", "c", "--tolerance", "1"}).code == 0);
}

TEST_CASE("hilda rerun refuses a folder that is no result")
{
    const Scratch in;
    CHECK(call(in, {"rerun", "none"}).code == 3);
    fs::create_directory(in / "a");
    CHECK_THAT(call(in, {"rerun", "a"}).err, Contains("contains no summary.json, study.json or fit.json"));
    write(in / "a/summary.json", "{}");
    CHECK_THAT(call(in, {"rerun", "a"}).err, Contains("has no command line"));
    write(in / "a/summary.json", R"({"provenance": {"command_line": "rm -r x"}})");
    const Ended other = call(in, {"rerun", "a"});
    CHECK(other.code == 3);
    CHECK_THAT(other.err, Contains("of no program of HILDA: rm -r x"));
}

TEST_CASE("hilda rerun repeats only commands that write a result, and loads no plug-in without consent")
{
    const Scratch in;
    fs::create_directory(in / "a");
    const auto refusal = [&](const std::string& command, int code) {
        write(in / "a/summary.json", R"({"provenance": {"command_line": ")" + command + "\"}}");
        const Ended ended = call(in, {"rerun", "a", "--output", "b"});
        INFO(command);
        CHECK(ended.code == code);
        CHECK(ended.out.empty());
        CHECK_FALSE(fs::exists(in / "b"));
        return ended.err;
    };
    for (const char* command : {"hilda rerun a", "hilda reproduce", "hilda view a", "hilda plot a", "hilda",
                                "hilda models double_pendulum --write x", "hilda import a.urdf --force",
                                "hilda --version", "hilda --load", "hilda new integrator mine"})
        CHECK_THAT(refusal(command, 3), Contains("is not repeated; hilda rerun repeats run, study, fit"));
    for (const char* command : {"hilda-granular cases --write x", "hilda granular cases bed --write=x",
                                "hilda-granular export bed --lammps", "hilda-granular bed --exchange"})
        CHECK_THAT(refusal(command, 3), Contains("is not repeated: it writes no result"));
    for (const char* command : {"hilda --load evil.so run double_pendulum", "hilda --load=evil.so run x",
                                "hilda --load ./evil.so rerun a"})
        CHECK_THAT(refusal(command, 2), Contains("the command loads the plug-in") && Contains("evil.so") &&
                                            Contains("rerun a permits it"));
}

TEST_CASE("hilda rerun repeats the results of several integrators, and of one of them")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "double_pendulum", "--integrator", "rA-half-1,rA-half-2", "--end", "0.02",
                      "--output", "a"})
                .code == 0);
    const Ended all = call(in, {"rerun", "a"});
    INFO(all.out << all.err);
    CHECK(all.code == 0);
    CHECK_THAT(all.out, Contains("rA-half-1/trajectory.csv: identical") &&
                            Contains("rA-half-2/trajectory.csv: identical"));
    const Ended one = call(in, {"rerun", "a/rA-half-2", "--output", "b"});
    INFO(one.out << one.err);
    CHECK(one.code == 0);
    CHECK_THAT(one.out, Contains("  trajectory.csv: identical"));

    write(in / "a/rA-half-1/more.csv", "t\n0\n");
    fs::remove(in / "a/rA-half-2/trajectory.csv");
    const Ended changed = call(in, {"rerun", "a", "--output", "c"});
    CHECK(changed.code == 6);
    CHECK_THAT(changed.out, Contains("rA-half-1/more.csv: is missing when repeated") &&
                                Contains("rA-half-2/trajectory.csv: exists only when repeated"));
}

TEST_CASE("hilda rerun writes beside the result, not into it")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.02", "--output", "a"}).code == 0);
    CHECK_THAT(call(in, {"rerun", "a", "--output", "a/b"}).err,
               Contains("a/b: is in the result that is repeated"));
    const Ended here = call(in, {"rerun", "a/."});
    INFO(here.out << here.err);
    CHECK(here.code == 0);
    CHECK(fs::exists(in / "a-again/trajectory.csv"));
    CHECK_FALSE(fs::exists(in / "a/.-again"));

    fs::remove_all(in / "a-again");
    std::string summary = read(in / "a/summary.json");
    const std::string command = "hilda run --end 0.02 --output a -- double_pendulum";
    const size_t at = summary.find("\"command_line\": \"") + 17;
    summary.replace(at, summary.find('"', at) - at, command);
    write(in / "a/summary.json", summary);
    const Ended behind = call(in, {"rerun", "a"});
    INFO(behind.out << behind.err);
    CHECK(behind.code == 0);
}

TEST_CASE("hilda rerun names input files that have changed")
{
    const Scratch in;
    const std::string rows = "t,angle\n0,0\n0.1,0.01\n0.2,0.04\n0.3,0.09\n0.4,0.16\n0.5,0.25\n";
    write(in / "angle.csv", rows);
    write(in / "crank.json", R"({"hilda_model": 1, "name": "crank", "end": 0.2,
        "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}],
        "constraints": [
            {"type": "revolute", "name": "axle", "body_i": "ground", "body_j": "bar",
             "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]},
            {"type": "hinge-driver", "name": "turn", "body_i": "ground", "body_j": "bar",
             "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1],
             "angle": {"file": "angle.csv", "column": "angle"}}]})");
    const Ended first = call(in, {"run", "crank.json", "--fix-initial", "--output", "a"});
    INFO(first.out << first.err);
    REQUIRE(first.code == 0);
    const std::string summary = read(in / "a/summary.json");
    CHECK_THAT(summary, Contains("\"inputs\"") && Contains("\"file\": \"crank.json\"") &&
                            Contains("angle.csv") && Contains(fmt::format("\"bytes\": {}", rows.size())));
    CHECK(call(in, {"rerun", "a"}).code == 0);
    write(in / "angle.csv", rows + "0.6,0.36\n");
    const Ended changed = call(in, {"rerun", "a", "--output", "b"});
    CHECK(changed.code == 6);
    CHECK_THAT(changed.out, Contains("different     input") && Contains("angle.csv: has changed since"));
    CHECK_THAT(changed.out, !Contains("input crank.json"));
}
