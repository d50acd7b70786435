// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

using namespace hilda;
using io::Json;
using nlohmann::ordered_json;

namespace {

std::string text(const ordered_json& json)
{
    return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("io::Json writes the text of nlohmann::ordered_json")
{
    SECTION("numbers, texts and truth values")
    {
        CHECK(io::Json().text() == "null\n");
        CHECK(io::Json(nullptr).text() == "null\n");
        CHECK(io::Json(true).text() == "true\n");
        CHECK(io::Json("a \"b\"\n").text() == text("a \"b\"\n"));
        for (const double x : {0.0, -0.0, 1.0, 0.1, 1e-300, 1e22, 1.0 / 3, -2.5e-7})
            CHECK(io::Json(x).text() == text(x));
        for (const double x :
             {1e-5, 9.99e-5, 1e-4, 123456.75, 1e14, 1e15, 123456789012345.6, 5e-324, 1.7976931348623157e308})
            CHECK(io::Json(x).text() == text(x));
        for (const double x : {infinity, -infinity, std::nan("")}) CHECK(io::Json(x).text() == "null\n");
        CHECK(io::Json(-3).text() == "-3\n");
        CHECK(io::Json(std::uint32_t{4294967295}).text() == "4294967295\n");
        CHECK(io::Json(std::size_t{1} << 53).text() == "9007199254740992\n");
        CHECK(io::Json(UINT64_MAX).text() == "18446744073709551615\n");
        CHECK(io::Json(INT64_MIN).text() == "-9223372036854775808\n");
        CHECK(io::Json("\xff").text() == text("\xff"));  // not UTF-8
        std::string all;
        for (int c = 0; c < 128; ++c) all += static_cast<char>(c);
        CHECK(io::Json(all).text() == text(all));
    }
    SECTION("the initializer list of a value")
    {
        const std::string name = "n";
        const std::vector<std::string> words = {"a", "b"};
        const io::Json ours = {{"name", name},
                               {"two", {"x", "y"}},
                               {"pairs", {{"k", 1}, {"l", {{"m", nullptr}}}}},
                               {"mixed", {{"k", 1}, 2.5}},
                               {"point", {0.5, 1.5, 2.5}},
                               {"words", words},
                               {"none", std::vector<int>{}},
                               {"empty", io::Json::object()}};
        const ordered_json theirs = {{"name", name},
                                     {"two", {"x", "y"}},
                                     {"pairs", {{"k", 1}, {"l", {{"m", nullptr}}}}},
                                     {"mixed", {{"k", 1}, 2.5}},
                                     {"point", {0.5, 1.5, 2.5}},
                                     {"words", words},
                                     {"none", std::vector<int>{}},
                                     {"empty", ordered_json::object()}};
        CHECK(ours.text() == text(theirs));
    }
    SECTION("changes")
    {
        io::Json ours;
        ordered_json theirs;
        ours["b"] = 1;
        theirs["b"] = 1;
        ours["a"]["c"].push_back("d");
        theirs["a"]["c"].push_back("d");
        ours.update({{"b", 2}, {"e", false}});
        theirs.update({{"b", 2}, {"e", false}});
        const io::Json copy = ours;
        ours["b"] = 3;
        CHECK(copy.text() == text(theirs));
        CHECK(copy.size() == 3);
        CHECK(ours.text() != copy.text());
    }
}

TEST_CASE("io::Json refuses operations of another kind of value")
{
    io::Json number = 1, array = io::Json::array();
    CHECK_THROWS_AS(number["a"], std::logic_error);
    CHECK_THROWS_AS(array["a"], std::logic_error);
    CHECK_THROWS_AS(number.push_back(1), std::logic_error);
    CHECK_THROWS_AS(array.update({1, 2}), std::logic_error);
    CHECK_THROWS_AS(array.at(0), std::out_of_range);
    CHECK(array.size() == 0);
}

TEST_CASE("messages describe a value in one line")
{
    CHECK(described(Json(0.5)) == "0.5");
    CHECK(described(Json(true)) == "true");
    CHECK(described(Json(std::nan(""))) == "nan");
    CHECK(described(Json(std::string(58, 'a') + "\u00fc\u00fc")) ==
          "\"" + std::string(58, 'a') + "\u00fc...\"");
    CHECK(described(Json{{"a", 1}}) == "an object of 1 key");
    CHECK(described(Json{{"a", 1}, {"b", 2}}) == "an object of 2 keys");
    CHECK(described(Json{0.5, 1.5, 2.5, 3.5}) == "[0.5, 1.5, 2.5, 3.5]");
    CHECK(described(Json{0.5, 1.5, 2.5, 3.5, 4.5}) == "a list of 5");
    CHECK(described(Json{"a", "b"}) == "a list of 2");
    CHECK(io::pointer_to("/a", "b/c~d") == "/a/b~1c~0d");
}
