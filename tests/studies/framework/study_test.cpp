// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace hilda::tests;
using Catch::Matchers::StartsWith;

namespace {

Ended convergence_study(const Scratch& in, const std::vector<std::string>& more)
{
    return call(in, with({"study", "convergence", "--problem", "double_pendulum", "--end", "0.3",
                          "--integrator", "rA-half-2", "--steps", "1e-2,5e-3,2.5e-3", "--no-plot"},
                         more));
}

}  // namespace

TEST_CASE("a study writes its table, and exits with 6 when an expectation fails", "[studies][study]")
{
    const Scratch in;
    const Ended passed = convergence_study(in, {"--expect", "order=2+-0.2"});
    CAPTURE(passed.err);
    CHECK(passed.code == 0);
    CHECK(fs::exists(in / "out/convergence/study.csv"));
    CHECK(fs::exists(in / "out/convergence/study.json"));

    CHECK(convergence_study(in, {}).code == 2);  // the directory is not empty
    const Ended failed = convergence_study(in, {"--expect", "order=7", "--force"});
    CHECK(failed.code == 6);
    CHECK_THAT(failed.err, StartsWith("hilda: error: expected order=7, got "));
}

TEST_CASE("a study with --json prints one object and writes files only with --output", "[studies][study]")
{
    const Scratch in;
    const Ended ended = convergence_study(in, {"--json"});
    CHECK(ended.code == 0);
    CHECK(nlohmann::json::parse(ended.out)["study"] == "convergence");
    CHECK_FALSE(fs::exists(in / "out"));
}

TEST_CASE("a study that cannot start leaves no directory", "[studies][study]")
{
    const Scratch in;
    CHECK(call(in, {"study", "convergence", "--problem", "none", "--output", "a"}).code == 3);
    CHECK_FALSE(fs::exists(in / "a"));
}

TEST_CASE("a study refuses a model file with a name that the file system does not accept", "[studies][study]")
{
    const Scratch in;
    const std::string name = std::string(300, 'a') + ".json";
    check_refused(in, {"study", "convergence", "--problem", name}, 3, name + ": there is no such file");
}

TEST_CASE("an error in a model file is placed with the path of the file", "[studies][study]")
{
    const Scratch in;
    fs::create_directory(in / "models");
    write(in / "models/swing.json", pendulum(R"(, {"name": "rod", "type": "distanse"})"));
    for (const char* kind : {"convergence", "energy", "compare", "iterations", "timing", "work-precision",
                             "evolving-order", "sweep"}) {
        std::vector<std::string> words = {"study", kind, "--problem", "models/swing.json", "--output", "a"};
        if (words[1] == "sweep") words.insert(words.end(), {"--sweep", "/bodies/0/mass=1,2"});
        const Ended ended = call(in, words);
        CAPTURE(kind, ended.err);
        CHECK(ended.code == 3);
        CHECK_THAT(ended.err, StartsWith("hilda: error: models/swing.json:4:"));
        CHECK_FALSE(fs::exists(in / "a"));
    }
    // a built-in model has no file
    CHECK_THAT(
        call(in, {"study", "energy", "--problem", "double_pendulum", "--set", "/bodies/0/mass=-1"}).err,
        StartsWith("hilda: error: double_pendulum:"));
}
