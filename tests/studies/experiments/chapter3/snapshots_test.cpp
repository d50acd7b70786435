// SPDX-License-Identifier: GPL-3.0-or-later
// Study snapshots: Table 3.1, poses at the times of the figures, models with contacts.
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("the constraints and degrees of freedom of the mechanisms are those of Table 3.1",
          "[studies][snapshots]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "snapshots", "--no-plot", "--quiet"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto rows = csv(in / "out/snapshots/study.csv");
    REQUIRE(rows.size() == 3);
    const std::vector<std::string> columns = {
        "CD", "DP1", "DP2", "D", "other_rows", "rows", "degrees_of_freedom"};
    const std::vector<std::vector<double>> published = {
        {6, 4, 0, 0, 0, 10, 2}, {6, 7, 4, 1, 0, 18, 0}, {12, 6, 0, 0, 0, 18, 0}};
    for (size_t k = 0; k < rows.size(); ++k)
        for (size_t c = 0; c < columns.size(); ++c) {
            CAPTURE(rows[k].at("problem"), columns[c]);
            CHECK(number(rows[k], columns[c]) == published[k][c]);
        }
    // four snapshots of each body; the crank turns by a quarter between two of them
    std::map<std::string, std::vector<CsvRow>> shown;
    for (const CsvRow& row : csv(in / "out/snapshots/poses.csv"))
        if (row.at("shown") == "1") shown[row.at("body")].push_back(row);
    CHECK(shown.size() == 8);
    for (const auto& [body, poses] : shown) CHECK(poses.size() == 4);
    for (size_t k = 0; k < 4; ++k) {
        const CsvRow& crank = shown["crank"][k];
        CHECK(number(crank, "t") == Approx(0.25 * static_cast<double>(k)));
        for (const char* A : {"A22", "A23", "A32", "A33"})
            CHECK(std::abs(number(crank, A)) ==
                  Approx(std::abs(number(shown["crank"][k % 2], A))).margin(1e-4));
        CHECK(number(crank, "A11") == Approx(1).margin(1e-9));
    }
    CHECK(number(shown["crank"][2], "A23") == Approx(-number(shown["crank"][0], "A23")).margin(1e-4));
    CHECK_FALSE(fs::exists(in / "out/snapshots/contacts.csv"));
}

TEST_CASE("snapshots of a model with a contact have its contact points", "[studies][snapshots]")
{
    const Scratch in;
    const Ended ended = call(
        in, {"study", "snapshots", "--problem", "rolling_ball,ball_in_bowl", "--end", "0.3", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    std::map<std::string, std::vector<CsvRow>> contacts;
    for (const CsvRow& row : csv(in / "out/snapshots/contacts.csv")) contacts[row.at("run")].push_back(row);
    REQUIRE(contacts.size() == 2);
    for (const CsvRow& row : contacts["rolling_ball"]) {
        CHECK(number(row, "Cz") == Approx(0).margin(1e-3));
        CHECK(number(row, "Nz") > 0);
        CHECK(number(row, "Fx") < 0);  // against the sliding
    }
    for (const CsvRow& row : contacts["ball_in_bowl"]) {
        const double x = number(row, "Cx") / 4, y = number(row, "Cy") / 3, z = number(row, "Cz") / 2;
        CHECK(x * x + y * y + z * z == Approx(1).epsilon(1e-9));  // on the bowl
    }
    CHECK(contacts["ball_in_bowl"].size() == 301);
}

TEST_CASE("study snapshots refuses what it cannot draw", "[studies][snapshots]")
{
    const Scratch in;
    const Ended two = call(in, {"study", "snapshots", "--integrator", "rA-half-1,rA-half-2", "--no-plot"});
    CHECK(two.code == 2);
    CHECK_THAT(two.err, Contains("--integrator takes one integrator here"));
    CHECK(call(in, {"study", "snapshots", "--problem", "slider_crnk", "--no-plot"}).code == 3);
    CHECK(call(in, {"study", "snapshots", "--end", "-1", "--no-plot"}).code == 2);
    CHECK(call(in, {"study", "snapshots", "--steps", "1e-3,1e-4", "--no-plot"}).code == 2);
}
