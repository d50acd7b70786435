// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/sweep/swept_values.hpp"

#include "io/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using Catch::Matchers::Contains;
using studies::swept_entries;
using studies::swept_entry;

namespace {

using Texts = std::vector<std::string>;

Texts values(const std::string& text) { return swept_entry("/a=" + text).values; }

}  // namespace

TEST_CASE("a sweep takes values, ranges and lists of JSON values", "[studies][sweep]")
{
    CHECK(swept_entry("/bodies/0/mass=1").pointer == "/bodies/0/mass");
    CHECK(values("1") == Texts{"1"});
    CHECK(values("1,2.5,-3e2") == Texts{"1", "2.5", "-3e2"});
    CHECK(values(" 1, 2 ") == Texts{"1", "2"});
    CHECK(values("[0,0,1],[0,1,0]") == Texts{"[0,0,1]", "[0,1,0]"});
    CHECK(values(R"({"a":[1,2],"b":","},"x,y",plain)") ==
          Texts{R"({"a":[1,2],"b":","})", R"("x,y")", "plain"});
    CHECK(values(R"("a\",b",c=d)") == Texts{R"("a\",b")", "c=d"});
    CHECK(values("true,false,null") == Texts{"true", "false", "null"});
    CHECK(values("0:1:5") == Texts{"0", "0.25", "0.5", "0.75", "1"});
    CHECK(values("3:1:3,10") == Texts{"3", "2", "1", "10"});
    CHECK(values("0.1:0.3:3") == Texts{"0.1", "0.2", "0.3"});  // without 0.30000000000000004
    CHECK(values("0.001:1:4:log").size() == 4);
    CHECK(values("0.001:1:4:log").front() == "0.001");
    CHECK(values("0.001:1:4:log").back() == "1");
    CHECK(std::stod(values("-1:-100:3:log")[1]) == Approx(-10));
    CHECK(values("a:b:3") == Texts{"a:b:3"});  // a text, not a range
    CHECK(values("max(1,2),2*min(l, (3)),pi") == Texts{"max(1,2)", "2*min(l, (3))", "pi"});
    CHECK(values("a),b(1,2),c") == Texts{"a)", "b(1,2)", "c"});
    CHECK(values("1,\"1\",[1]") == Texts{"1", "\"1\"", "[1]"});  // a number, a text and a list
}

TEST_CASE("a sweep of another form is refused", "[studies][sweep]")
{
    const auto refused = [](const std::string& text, const std::string& why) {
        CAPTURE(text);
        CHECK_THROWS_AS(swept_entry(text), io::UsageError);
        CHECK_THROWS_WITH(swept_entry(text), Contains(why));
    };
    for (const char* text : {"", "/a", "a=1", "=1"}) refused(text, "must be /json/pointer=VALUE,VALUE,...");
    for (const char* text : {"/a=", "/a=1,,2", "/a=1,", "/a=,1", "/a= "})
        refused(text, "without empty values");
    for (const char* text : {"/a=1,1", "/a=0:1:2,1", "/a=x,x"}) refused(text, "must contain each value once");
    refused("/a=10,10.0", "must contain each value once, and 10 and 10.0 are equal, got '/a=10,10.0'");
    for (const char* text : {"/a=10,1e1", "/a=0,-0", "/a=0:1:11,0.50", "/a=[1,0],[1.0, 0]", "/a=x,\"x\"",
                             "/a=2*pi,pi*2", "/a=1/2,0.5"})
        refused(text, "are equal, got");
    for (const char* text :
         {"/a=0:1:1", "/a=0:1:0", "/a=0:1:-2", "/a=0:1:2.5", "/a=0:1:100001", "/a=0:1:1e9"})
        refused(text, "a whole number from 2 to 100000");
    refused("/a=1:1:3", "limits of a range must differ");
    for (const char* text : {"/a=0:1:3:log", "/a=-1:1:3:log"}) refused(text, "must have the same sign");
    refused("/a=1:2:3:lin", "A:B:N:log");
    CHECK_THROWS_WITH(swept_entries({"/a=1", "/b=2", "/a=3"}), Contains("is given twice for /a"));
    CHECK_THROWS_WITH(swept_entries({"/a=0:1:1000", "/b=0:1:101"}),
                      Contains("more than 100000 combinations"));
}

TEST_CASE("the combinations of a sweep are all, with the last entry fastest", "[studies][sweep]")
{
    const auto entries = swept_entries({"/a=1,2", "/b=x,y,z"});
    REQUIRE(studies::combinations(entries) == 6);
    CHECK(studies::combination(entries, 0) == Texts{"1", "x"});
    CHECK(studies::combination(entries, 1) == Texts{"1", "y"});
    CHECK(studies::combination(entries, 3) == Texts{"2", "x"});
    CHECK(studies::combination(entries, 5) == Texts{"2", "z"});
}
