// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/run_settings.hpp"

#include <catch2/catch.hpp>

using hilda::run::difference;
using hilda::run::RunSettings;

TEST_CASE("settings of two runs that differ are named with both values, in one line", "[run][resume]")
{
    const RunSettings a = {{"--step", "0.001"}, {"--vtk", "0.1"}, {"--fix-initial", ""}, {"model", "1"}},
                      b = {{"--step", "0.002"}, {"--vtk", "0.1"}, {"--reactions", ""}, {"model", "1"}};
    CHECK(difference(a, a, "", "").empty());
    CHECK(difference(a, b, "", "") ==
          "it has --fix-initial, no --reactions, --step 0.001; this run has no --fix-initial, --reactions, "
          "--step "
          "0.002");
}

TEST_CASE("of two models the first entry that differs is named with both values", "[run][resume]")
{
    const RunSettings a = {{"model", "1"}}, b = {{"model", "2"}};
    const auto differs = [&](const std::string& earlier, const std::string& now) {
        return difference(a, b, earlier, now);
    };
    const std::string whole = R"({"name": "m", "bodies": [{"mass": 1, "r": [0, 0, 1]}]})";
    CHECK(differs(whole, R"({"name": "m", "bodies": [{"mass": 1, "r": [0, 0, 2]}]})") ==
          "it has /bodies/0/r/2 1; this run has /bodies/0/r/2 2");
    CHECK(differs(whole, R"({"name": "m", "bodies": [{"mass": "heavy", "r": [0, 0, 1]}]})") ==
          "it has /bodies/0/mass 1; this run has /bodies/0/mass \"heavy\"");
    CHECK(differs(whole, R"({"name": "m", "bodies": []})") ==
          "it has /bodies a list of 1; this run has /bodies []");
    CHECK(differs(whole, R"({"name": "m"})") == "it has /bodies a list of 1; this run has no /bodies");
    CHECK(differs(R"({"name": "m"})", whole) == "it has no /bodies; this run has /bodies a list of 1");
    for (const char* unreadable : {"", "{"})
        CHECK(differs(unreadable, whole) == "it has another model; this run has the model given");
    CHECK(differs(whole, whole) == "it has another model; this run has the model given");
}
