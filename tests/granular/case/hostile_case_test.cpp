// SPDX-License-Identifier: GPL-3.0-or-later
// Systematic changes of the example case: each is read, or refused with its place. The messages have the form
// of those of models, because both are read by io::ObjectReader.
#include "granular/case/case_file.hpp"
#include "io/files.hpp"
#include "io/object_reader.hpp"
#include "tests/support/paths.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <regex>

using namespace hilda;
using nlohmann::ordered_json;

namespace {

ordered_json example()
{
    ordered_json bed = ordered_json::parse(
        io::read_file(std::string(tests::source_dir) + "/granular/cases/bed.json", std::size_t{1} << 20));
    bed["fill"][0]["high"] = {0.04, 0.04, 0.01};  // fewer particles, so that the test is fast
    return bed;
}

/// "" if the case is read, or the message
std::string message_of(const std::string& text)
{
    try {
        granular::read_case(text, "case.json", {.memory = std::size_t{1} << 30});
        return "";
    } catch (const io::InvalidInput& e) {
        return e.what();
    }
}

/// Pointers of all values below a value
void collect(const ordered_json& v, const std::string& at, std::vector<std::string>& all)
{
    if (!at.empty()) all.push_back(at);
    if (!v.is_structured()) return;
    for (const auto& [key, member] : v.items()) collect(member, at + '/' + key, all);
}

}  // namespace

TEST_CASE("each changed value of the example case is read, or refused with its place", "[granular][case]")
{
    const ordered_json good = example();
    REQUIRE(message_of(good.dump()).empty());
    std::vector<std::string> pointers;
    collect(good, "", pointers);
    std::vector<std::string> texts;
    const std::vector<ordered_json> values = {nullptr,
                                              true,
                                              0,
                                              -1,
                                              1e39,
                                              -1e39,
                                              1e300,
                                              1e-300,
                                              0.5,
                                              "NaN",
                                              "t",
                                              "",
                                              ordered_json::array(),
                                              ordered_json::object(),
                                              {1, 2, 3},
                                              {"a", nullptr}};
    for (const std::string& pointer : pointers) {
        const ordered_json::json_pointer at(pointer);
        for (const ordered_json& value : values) {
            ordered_json c = good;
            c[at] = value;
            texts.push_back(c.dump());
        }
        ordered_json& parent = const_cast<ordered_json&>(good.at(at.parent_pointer()));
        if (!parent.is_object()) continue;
        ordered_json without = good, misspelt = good, twice = good;
        without[at.parent_pointer()].erase(at.back());
        misspelt[at.parent_pointer()].erase(at.back());
        misspelt[at.parent_pointer()][at.back() + "x"] = good[at];
        twice[at.parent_pointer()]["duplicate of the key"] = good[at];
        texts.push_back(without.dump());
        texts.push_back(misspelt.dump());
        texts.push_back(std::regex_replace(twice.dump(), std::regex("duplicate of the key"), at.back()));
        CHECK_THAT(message_of(texts.back()), Catch::Contains("is given twice; first at case.json:1:"));
        CHECK_THAT(message_of(misspelt.dump()),
                   Catch::Contains("unknown key \"" + at.back() + "x\"") ||
                       Catch::Contains("missing key '" + at.back() + "'") ||
                       Catch::Contains(" a case must have at least one material"));
        ordered_json nan = good;
        nan[at] = "not a number";
        texts.push_back(std::regex_replace(nan.dump(), std::regex("\"not a number\""), "NaN"));
        CHECK_THAT(message_of(texts.back()),
                   Catch::EndsWith("not JSON: invalid literal, got 'NaN'; numbers must be finite"));
    }
    static const std::regex form(R"(case\.json:[1-9]\d*:[1-9]\d* \((/[^ ]*)\): .+)");
    int refused = 0;
    for (const std::string& text : texts) {
        const std::string message = message_of(text);
        if (message.empty()) continue;
        ++refused;
        INFO(text);
        INFO(message);
        CHECK(std::regex_match(message, form));
    }
    CHECK(texts.size() > 500);
    CHECK(refused > 400);
}
