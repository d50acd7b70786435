// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/validation.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <set>

using namespace hilda::granular;

namespace {

void check_validation(const std::string& name)
{
    for (const Validation& v : hilda::io::Registry<Validation>::all()) {
        if (v.name != name) continue;
        double share = 0;
        bool forward = true;
        ValidationOptions options;
        options.progress = [&](double now) { forward &= now >= share && now < 1.0001, share = now; };
        const ValidationResult result = v.run(options);
        REQUIRE_FALSE(result.tables.empty());
        std::set<std::string> names;
        for (const ValidationTable& t : result.tables) {
            INFO(t.name);
            CHECK(names.insert(t.name).second);
            CHECK_FALSE(t.rows.empty());
            for (const auto& row : t.rows) REQUIRE(row.size() == t.columns.size());
        }
        REQUIRE_FALSE(result.checks.empty());
        for (const ValidationCheck& c : result.checks) {
            INFO(c.what << ": " << c.measured << " of [" << c.lower << ", " << c.upper << "]");
            CHECK(c.passed());
        }
        CHECK(forward);
        return;
    }
    FAIL("no validation is named " << name);
}

}  // namespace

TEST_CASE("validation: head-on (long)", "[granular][validation]") { check_validation("head-on"); }
TEST_CASE("validation: brick (long)", "[granular][validation]") { check_validation("brick"); }
TEST_CASE("validation: oblique", "[granular][validation]") { check_validation("oblique"); }

TEST_CASE("the warnings of a validation are those of the watch over each of its runs",
          "[granular][validation]")
{
    ValidationWarnings warnings;
    WatchRecord quiet, deep, fast, deeper;
    deep.warnings = WatchRecord::deep, deep.largest_overlap = 0.06;
    fast.warnings = WatchRecord::fast, fast.largest_displacement = 0.2;
    deeper.warnings = WatchRecord::deep | WatchRecord::fast;
    deeper.largest_overlap = 0.08, deeper.largest_displacement = 0.15;
    warnings.include("first", quiet);
    CHECK(warnings.all().empty());
    CHECK(warnings.largest().empty());
    warnings.include("first", deep);
    warnings.include("second", deeper);
    warnings.include("first", fast);  // a second world of this run
    REQUIRE(warnings.all().size() == 4);
    const auto largest = warnings.largest();
    REQUIRE(largest.size() == 2);
    CHECK(largest[0].name == "overlap_large");
    CHECK_THAT(largest[0].text,
               Catch::StartsWith("second: an overlap of 0.08 ") && Catch::EndsWith(" (less in 1 other run)"));
    CHECK(largest[1].name == "step_coarse");
    CHECK_THAT(largest[1].text, Catch::StartsWith("first: a grain moves by 0.2 ") &&
                                    Catch::EndsWith(" (less in 1 other run)"));
}

TEST_CASE("validations are listed by name, each with a description of one line", "[granular][validation]")
{
    // The functions of the comparison cases, cratering, drum, low-velocity cratering, repose, shear,
    // stacking, waves and wheel have separate tests. The validations take half a minute and more and are run
    // as studies, as is hopper.
    std::set<std::string> tested = {"brick",           "comparison-drum", "comparison-penetration",
                                    "comparison-silo", "cratering",       "drum",
                                    "head-on",         "hopper",          "low-velocity-cratering",
                                    "oblique",         "repose",          "shear",
                                    "stacking",        "waves",           "wheel"};
    std::string last;
    for (const Validation& v : hilda::io::Registry<Validation>::all()) {
        CHECK(last < v.name);
        last = v.name;
        CHECK_FALSE(v.description.empty());
        CHECK(v.description.find('\n') == std::string::npos);
        INFO("a test case must run " << v.name);
        CHECK(tested.erase(v.name) == 1);
    }
    CHECK(tested.empty());
}

TEST_CASE("a check fails if its value is NaN or out of bounds", "[granular][validation]")
{
    const double none = std::nan(""), inf = std::numeric_limits<double>::infinity();
    CHECK_FALSE(ValidationCheck{"", none, -inf, inf}.passed());
    CHECK(ValidationCheck{"", 1, 1, 1}.passed());
    CHECK_FALSE(ValidationCheck{"", 1.1, 0, 1}.passed());
    for (const auto& [a, b] : {std::pair(none, 1.), std::pair(1., none), std::pair(none, none)})
        CHECK((std::isnan(max_or_nan(a, b)) && std::isnan(min_or_nan(a, b))));
    for (const auto& [a, b] : {std::pair(1., 2.), std::pair(2., 1.)})
        CHECK((max_or_nan(a, b) == 2 && min_or_nan(a, b) == 1));
}
