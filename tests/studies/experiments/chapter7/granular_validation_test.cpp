// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

TEST_CASE("a granular validation is a study that writes its tables as files", "[studies][granular]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "granular-oblique", "--no-plot", "--check"});
    CAPTURE(ended.err);
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("18 of 18 passed"));

    const auto rows = csv(in / "out/granular-oblique/study.csv");
    REQUIRE(rows.size() == 34);  // two laws, one angle every five degrees
    for (const CsvRow& row : rows) {
        CHECK(number(row, "from_normal") + number(row, "from_surface") == Approx(90));
        if (number(row, "from_normal") < 64.5)
            CHECK(row.at("e_t_sliding").empty());
        else
            CHECK(number(row, "e_t") == Approx(number(row, "e_t_sliding")).epsilon(1e-4));
    }
    CHECK(csv(in / "out/granular-oblique/reference.csv").size() > 88);
    CHECK(csv(in / "out/granular-oblique/steps.csv").size() == 24);
    CHECK(csv(in / "out/granular-oblique/levers.csv").size() == 30);

    const auto json = nlohmann::json::parse(read(in / "out/granular-oblique/study.json"));
    CHECK(json["study"] == "granular-oblique");
    CHECK(json["grid"] == "quick");
    CHECK(json["checks"].size() == 18);
    for (const auto& check : json["checks"]) CHECK(check["passed"] == true);

    // both laws have overlaps of 5.4 % of the radius
    CHECK_THAT(ended.err, Contains("warning: study granular-oblique: mindlin") &&
                              Contains(": an overlap of 0.0537 of the smaller radius is above 0.05") &&
                              Contains("(less in 1 other run)"));
    CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
    REQUIRE(json["warnings"].size() == 2);
    CHECK_THAT(json["warnings"][0].get<std::string>(),
               StartsWith("overlap_large: mindlin: an overlap of 0.0537"));
    CHECK_THAT(json["warnings"][1].get<std::string>(),
               StartsWith("overlap_large: mindlin-incremental: an overlap of 0.0537"));
}

TEST_CASE("a granular study rejects options that it does not have", "[studies][granular]")
{
    const Scratch in;
    CHECK(call(in, {"study", "granular-oblique", "--grid", "coarse"}).code == 2);
    CHECK(call(in, {"study", "granular-oblique", "--steps", "1e-3"}).code == 2);
    CHECK(call(in, {"study", "granular-oblique", "--expect", "e_t=1"}).code == 2);
    CHECK_FALSE(fs::exists(in / "out/granular-oblique"));
}

TEST_CASE("the granular studies are in the sorted list of studies", "[studies][granular]")
{
    const Scratch in;
    const auto listed = nlohmann::json::parse(call(in, {"study", "--json"}).out);
    std::vector<std::string> kinds;
    for (const auto& study : listed) {
        kinds.push_back(study["kind"]);
        CHECK_FALSE(study["answers"].get<std::string>().empty());
    }
    CHECK(std::is_sorted(kinds.begin(), kinds.end()));
    for (const char* kind : {"granular-brick", "granular-head-on", "granular-oblique"})
        CHECK(std::count(kinds.begin(), kinds.end(), kind) == 1);
}

TEST_CASE("hilda granular runs a validation by name", "[studies][granular]")
{
    const Scratch in;
    const Ended ended = call(in, {"granular", "oblique"});
    CHECK(ended.code == 0);
    CHECK_THAT(ended.out, Contains("18 of 18 passed"));
    CHECK(call(in, {"granular", "oblique", "--quiet"}).out.empty());

    const Ended unknown = call(in, {"granular", "obliqe"});
    CHECK(unknown.code == 3);
    CHECK_THAT(unknown.err,
               Contains("obliqe: does not exist") && Contains("validations: ") && Contains("oblique"));
    CHECK(std::count(unknown.err.begin(), unknown.err.end(), '\n') == 1);

    // A file of this name is given with its folder.
    write(in / "oblique", "{}");
    CHECK(call(in, {"granular", "oblique", "--quiet"}).code == 0);
    CHECK(call(in, {"granular", "./oblique"}).code == 3);  // the file is not a valid case
    CHECK(call(in, {"granular", "./oblique", "--full"}).code == 2);
}
