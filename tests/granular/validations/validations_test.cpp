// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/validation.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <set>

using namespace hilda::granular;

namespace {

void comes_out(const std::string& name)
{
    for (const Validation& v : validations()) {
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
            INFO(c.what << ": " << c.measured << " of [" << c.least << ", " << c.most << "]");
            CHECK(c.met());
        }
        CHECK(forward);
        return;
    }
    FAIL("no validation is named " << name);
}

}  // namespace

TEST_CASE("validation: head-on (long)", "[granular][validation]") { comes_out("head-on"); }
TEST_CASE("validation: brick (long)", "[granular][validation]") { comes_out("brick"); }
TEST_CASE("validation: oblique", "[granular][validation]") { comes_out("oblique"); }

TEST_CASE("validations are listed by name, each with what it answers", "[granular][validation]")
{
    // what stacking and waves are made of has tests of its own; they take half a minute and more, and are left to the
    // studies
    std::set<std::string> tested = {"brick", "head-on", "oblique", "stacking", "waves"};
    std::string last;
    for (const Validation& v : validations()) {
        CHECK(last < v.name);
        last = v.name;
        CHECK_FALSE(v.answers.empty());
        CHECK(v.answers.find('\n') == std::string::npos);
        INFO("a test case must run " << v.name);
        CHECK(tested.erase(v.name) == 1);
    }
    CHECK(tested.empty());
}

TEST_CASE("a check that measures nothing is not met", "[granular][validation]")
{
    const double none = std::nan(""), inf = std::numeric_limits<double>::infinity();
    CHECK_FALSE(ValidationCheck{"", none, -inf, inf}.met());
    CHECK(ValidationCheck{"", 1, 1, 1}.met());
    CHECK_FALSE(ValidationCheck{"", 1.1, 0, 1}.met());
    for (const auto& [a, b] : {std::pair(none, 1.), std::pair(1., none), std::pair(none, none)})
        CHECK(std::isnan(worse(a, b)));
    CHECK(worse(1, 2) == 2);
    CHECK(worse(2, 1) == 2);
}
