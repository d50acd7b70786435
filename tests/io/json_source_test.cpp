// SPDX-License-Identifier: GPL-3.0-or-later
// Parser of JSON texts: values, locations and errors. nlohmann::json is the independent reference.
#include "io/json_source.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

using namespace hilda;
using io::Json;
using io::JsonSource;

namespace {

Json parsed(const std::string& text) { return JsonSource(text, "f").root; }

/// Message of reading a text, or its canonical form if it is valid
std::string outcome(const std::string& text)
{
    try {
        return written(parsed(text));
    } catch (const io::PlacedError& e) {
        return e.what();
    }
}

bool is_valid(const std::string& text)
{
    try {
        parsed(text);
        return true;
    } catch (const io::PlacedError&) {
        return false;
    }
}

}  // namespace

TEST_CASE("numbers of a JSON text are the nearest doubles", "[io][json]")
{
    const std::pair<const char*, double> numbers[] = {
        {"0", 0},         {"-0", -0.0},       {"-0.0", -0.0},
        {"12", 12},       {"0.1", 0.1},       {"1e5", 1e5},
        {"1E+5", 1e5},    {"1.5e-3", 1.5e-3}, {"9007199254740991", 9007199254740991},
        {"1e300", 1e300}, {"5e-324", 5e-324}, {"123456789012345678e0", 123456789012345678.}};
    for (const auto& [text, x] : numbers) {
        INFO(text);
        const Json v = parsed(text);
        CHECK(*v.number() == x);
        CHECK(std::signbit(*v.number()) == std::signbit(x));
    }
    for (const char* wrong : {"01", "-", "+1", "1.", ".5", "1e", "1e+", "0x10", "1_000", "NaN", "-Infinity",
                              "1e400", "1e-400", "9007199254740993", "--1", "1.e5", "- 1"}) {
        INFO(wrong);
        CHECK_FALSE(is_valid(wrong));
    }
}

TEST_CASE("strings of a JSON text are UTF-8 with the escapes of RFC 8259", "[io][json]")
{
    const std::pair<std::string, std::string> strings[] = {
        {R"("")", ""},
        {R"("\"\\\/\b\f\n\r\t")", "\"\\/\b\f\n\r\t"},
        {R"("\u0041\u00e9\u20AC")", "A\xC3\xA9\xE2\x82\xAC"},
        {R"("\ud83d\ude00")", "\xF0\x9F\x98\x80"},
        {R"("\u0000")", std::string(1, '\0')},
        {"\"\x7f\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\xF4\x8F\xBF\xBF\"",
         "\x7f\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\xF4\x8F\xBF\xBF"}};
    for (const auto& [text, s] : strings) {
        INFO(text);
        CHECK(*parsed(text).string() == s);
    }
    const std::string ill_formed[] = {"\x80",
                                      "\xC0\x80",
                                      "\xC1\xBF",
                                      "\xE0\x9F\xBF",
                                      "\xED\xA0\x80",
                                      "\xED\xBF\xBF",
                                      "\xF0\x8F\xBF\xBF",
                                      "\xF4\x90\x80\x80",
                                      "\xF5\x80",
                                      "\xFF",
                                      "\xC3",
                                      "\xE2\x82",
                                      "\xC3(",
                                      "\xE2(\xA1",
                                      "\xF0\x9F\x98"};
    for (const std::string& s : ill_formed) {
        CHECK_THAT(outcome("[\"ab" + s + "\"]"),
                   Catch::StartsWith("f:1:5 (/0): not JSON: invalid string: ill-formed UTF-8"));
        CHECK(nlohmann::json::accept("[\"ab" + s + "\"]") == false);
    }
    const std::pair<std::string, std::string> wrong[] = {
        {R"("\q")", "f:1:3 (/): not JSON: invalid string: forbidden character after backslash, got 'q'"},
        {R"("\u12g4")",
         "f:1:6 (/): not JSON: invalid string: '\\u' must be followed by 4 hex digits, got 'g4'"},
        {R"("\ud83d")", "must be followed by U+DC00..U+DFFF"},
        {R"("\ud83d\u0041")", "must be followed by U+DC00..U+DFFF"},
        {R"("\ude00")", "must be followed by U+DC00..U+DFFF"},
        {"\"a\tb\"", "f:1:3 (/): not JSON: invalid string: a control character must be escaped, got byte 9"},
        {std::string("\"a\0b\"", 5), "a control character must be escaped, got byte 0"},
        {"\"\\", "forbidden character after backslash, got the end of the text"},
        {"\"ab", "f:1:1 (/): not JSON: invalid string: missing closing quote, got \"ab\""},
        {"[\"ab\n\"]", "f:1:2 (/0): not JSON: a string must be closed on its line, got \"ab\""}};
    for (const auto& [text, message] : wrong) CHECK_THAT(outcome(text), Catch::Contains(message));
}

TEST_CASE("a text is one JSON value and nothing else", "[io][json]")
{
    CHECK(outcome(" \r\n\t[true, false, null] \n") == "[true, false, null]");
    CHECK(outcome("{}{}") == "f:1:3 (/): not JSON: unexpected '{'; expected the end of the text");
    CHECK(outcome(std::string("{}\0", 3)) ==
          "f:1:3 (/): not JSON: invalid literal, got byte 0; expected the end of the text");
    CHECK(outcome("{} x") == "f:1:4 (/): not JSON: invalid literal, got 'x'; expected the end of the text");
    CHECK(outcome("[1 2]") ==
          "f:1:4 (/1): not JSON: unexpected number literal, got '2'; expected ']' or ','");
    CHECK(outcome("{\"a\" 1}") == "f:1:6 (/a): not JSON: unexpected number literal, got '1'; expected ':'");
    CHECK(outcome("{1: 2}") ==
          "f:1:2 (/): not JSON: unexpected number literal, got '1'; expected a key in double quotes");
    CHECK(outcome("[1,]") == "f:1:3 (/1): not JSON: a comma without a following value, before ']'");
    CHECK(outcome("[,]") == "f:1:2 (/0): not JSON: unexpected ','; expected a value");
    CHECK(outcome("[TRUE]") == "f:1:2 (/0): not JSON: invalid literal, got 'TRUE'; expected a value");
    CHECK(outcome("{\"a\": {\"b\": [1, {\"c\": 2, \"c\": 3}]}}") ==
          "f:1:26 (/a/b/1/c): the key \"c\" is given twice; first at f:1:18 (/)");
    CHECK(outcome("{\"a\": 1, \"\\u0061\": 2}") ==
          "f:1:10 (/a): the key \"a\" is given twice; first at f:1:2 (/)");
    CHECK(is_valid(std::string(64, '[') + std::string(64, ']')));
    CHECK_FALSE(is_valid(std::string(65, '[') + std::string(65, ']')));
}

TEST_CASE("a text has a largest size, number of values and length of its strings", "[io][json]")
{
    const std::string bytes = std::to_string(JsonSource::max_bytes);
    CHECK(is_valid(std::string(JsonSource::max_bytes - 1, ' ') + '1'));
    CHECK(outcome(std::string(JsonSource::max_bytes, ' ') + '1') ==
          "f:1:1 (/): the text has " + std::to_string(JsonSource::max_bytes + 1) + " bytes; at most " +
              bytes + " are allowed");

    std::string values = "[1";
    for (std::size_t k = 2; k < JsonSource::max_values; ++k) values += ",1";
    CHECK(is_valid(values + "]"));
    CHECK_THAT(outcome(values + ",1]"), Catch::EndsWith("the text has more than 2000000 values"));

    const auto read = [](std::size_t length) {
        return JsonSource("[\"" + std::string(length, 'a') + "\"]", "f", 100).root;
    };
    CHECK(read(100).at(0).string()->size() == 100);
    CHECK_THROWS_WITH(read(101), "f:1:2 (/0): a string of 101 bytes, got \"" + std::string(60, 'a') +
                                     "...\"; at most 100 are allowed");
}

TEST_CASE("a byte order mark is skipped and not counted as a column", "[io][json]")
{
    CHECK(outcome("\xEF\xBB\xBF{\"a\": 1}") == outcome("{\"a\": 1}"));
    CHECK_THAT(outcome("\xEF\xBB\xBF{\"\xC3\xA9\": x}"), Catch::StartsWith("f:1:7 (/\xC3\xA9): "));
    CHECK_THAT(outcome("\xEF\xBB\xBF"), Catch::StartsWith("f:1:1 (/): the text is empty"));
    CHECK_FALSE(is_valid(std::string("\xFF\xFE{\0}\0", 6)));
}

TEST_CASE("mutated texts are valid for the parser where they are valid for nlohmann::json", "[io][json]")
{
    const std::string text =
        "{\"a\": [1, -2.5e3, true, null, \"\\u00e9\\n\xC3\xA9\"], \"b\": {\"c\": {}, \"d\": []}, \"e\": "
        "0.25}";
    static const std::string alphabet = "{}[]\",:.-+eE019 \nntu\\/\xC3\xA9\x01";
    std::mt19937 random(7);
    int valid = 0;
    for (int k = 0; k < 20000; ++k) {
        std::string t = text;
        for (auto n = 1 + random() % 3; n > 0; --n) {
            const std::size_t at = random() % t.size();
            if (random() % 2 == 0)
                t[at] = alphabet[random() % alphabet.size()];
            else if (random() % 2 == 0)
                t.erase(at, 1 + random() % 5);
            else
                t.insert(at, 1, alphabet[random() % alphabet.size()]);
        }
        INFO(t);
        const std::string found = outcome(t);
        const bool ours = found.substr(0, 2) != "f:";
        // Duplicate keys and inexact numbers are invalid here only.
        if (!ours && (found.find("twice") != std::string::npos ||
                      found.find("the number is outside") != std::string::npos ||
                      found.find("too large to be exact") != std::string::npos))
            continue;
        REQUIRE(ours == nlohmann::json::accept(t));
        if (!ours) continue;
        ++valid;
        REQUIRE(nlohmann::json::parse(found) == nlohmann::json::parse(t));
    }
    CHECK(valid > 500);
}

TEST_CASE("a change replaces a value or adds a key, and its errors name the option", "[io][json]")
{
    const auto changed = [](const std::string& change) {
        JsonSource source(R"({"a": [1, {"b/~": 2}], "c": "x"})", "f");
        source.set(change);
        return written(source.root["a"]) + written(source.root["c"]);
    };
    CHECK(changed("/a/0=true") == changed("/a/0= true"));
    CHECK_THAT(changed("/a/1/b~1~0=[3]"), Catch::Contains("\"b/~\": [3]"));
    CHECK_THAT(changed("/c=a plain text"), Catch::EndsWith("\"a plain text\""));
    CHECK_THAT(changed("/a/1/new={\"k\": null}"), Catch::Contains("\"new\": {"));
    CHECK_THROWS_WITH(changed("/a/2=1"), "f:1:7 (/a): --set \"/a/2=1\": there is no \"2\" in a list of 2");
    CHECK_THROWS_WITH(changed("/c={\"k\": 1, \"k\": 2}"),
                      Catch::StartsWith("f:1:29 (/c): --set \"/c={\\\"k\\\": 1, \\\"k\\\": 2}\": VALUE:1:10 "
                                        "(/k): the key \"k\" is given twice"));
    CHECK_THROWS_WITH(changed("/c=\xFF"), Catch::Contains("must be UTF-8"));
    for (const char* pointer : {"/a/1/b~", "/a/1/b~2"})
        CHECK_THROWS_WITH(changed(std::string(pointer) + "=1"),
                          Catch::Contains("'~' is written ~0 in a pointer, and '/' in a key is ~1"));
    CHECK_THROWS_WITH(changed("c=1"), Catch::Contains("must be /json/pointer=VALUE"));

    JsonSource source(R"({"a": 1})", "f");
    CHECK(source.current_text() == R"({"a": 1})");
    source.set("/a=2", "--a 2");
    CHECK(source.current_text() == "{\n  \"a\": 2\n}\n");
    CHECK_THROWS_WITH(source.fail("/a", "must be 1"), "f:1:7 (/a): must be 1 (from --a 2)");
}

TEST_CASE("a renamed key is read under its old name, with a notice", "[io][json]")
{
    JsonSource source("{\"x\": 0,\n \"old\": 1}", "f");
    source.rename("old", "new");
    CHECK(source.root.member("old") == nullptr);
    CHECK(*source.root.member("new")->value.number() == 1);
    REQUIRE(source.notices.size() == 1);
    CHECK(source.notices[0] == "f:2:9 (/old): old was renamed to new; the old name is still read");
    CHECK_THROWS_WITH(source.fail("/new", "must be 2"), "f:2:9 (/old): must be 2");
    CHECK_THAT(source.current_text(), Catch::Contains("\"new\": 1"));

    JsonSource both("{\"old\": 1, \"new\": 2}", "f");
    CHECK_THROWS_WITH(both.rename("old", "new"),
                      "f:1:9 (/old): old is the old name of new, which is given as well; remove one of them");
    JsonSource none("{}", "f");
    none.rename("old", "new");
    CHECK(none.notices.empty());
    none.set("/old=3");
    CHECK(*none.root.member("new")->value.number() == 3);
    CHECK(none.notices.size() == 1);
}

TEST_CASE("columns of a long line are counted in characters", "[io][json]")
{
    // elements of 8 characters in 9 bytes; the pointer of element k is /k, its column 2 + 9 k
    std::string text = "[";
    for (int k = 0; k < 500; ++k) text += k > 0 ? ",\"\u00e4bcdef\"" : "\"\u00e4bcdef\"";
    const JsonSource source(text + "]", "f");
    for (const int k : {0, 1, 25, 28, 29, 57, 499})
        CHECK(source.place("/" + std::to_string(k)) ==
              "f:1:" + std::to_string(2 + 9 * k) + " (/" + std::to_string(k) + ")");
}

TEST_CASE("the place of a value in the text is found by its pointer", "[io][json]")
{
    const JsonSource source(
        "{\"a\": {\"b]\\\"}\": [1, {\"x\": []}],\n   \"c\" : [[], \"]\", -1e5 ,[2,\n 33]]}, \"d\":{ }}\n",
        "f");
    const std::pair<std::string, std::string> places[] = {{"", "1:1"},
                                                          {"/a", "1:7"},
                                                          {"/a/b]\"}/0", "1:18"},
                                                          {"/a/b]\"}/1", "1:21"},
                                                          {"/a/b]\"}/1/x", "1:27"},
                                                          {"/a/c/0", "2:11"},
                                                          {"/a/c/1", "2:15"},
                                                          {"/a/c/2", "2:20"},
                                                          {"/a/c/3/1", "3:2"},
                                                          {"/d", "3:13"},
                                                          {"/d/e", "3:13"},
                                                          {"/a/c/3/2/f", "2:26"},
                                                          {"/z", "1:1"}};
    for (const auto& [pointer, place] : places)
        CHECK(source.place(pointer) == "f:" + place + " (" + (pointer.empty() ? "/" : pointer) + ")");
}

TEST_CASE("an error has the pointer of its entry and the reason without the location", "[io][json]")
{
    const auto pointer_and_reason = [](const auto& f) {
        try {
            f();
        } catch (const io::PlacedError& e) {
            CHECK_THAT(e.what(), Catch::Contains(e.reason));
            return e.pointer + " | " + e.reason;
        }
        return std::string("no error");
    };
    JsonSource source(R"({"a": {"b (c): d": [1, 2]}})", "f (x): y");
    CHECK(pointer_and_reason([&] { source.fail("/a/b (c): d/1", "it (z): is wrong"); }) ==
          "/a/b (c): d/1 | it (z): is wrong");
    CHECK(pointer_and_reason([&] { source.set("/a/e/g=3", "option"); }) ==
          "/a | there is no \"e\" in an object of 1 key");
    source.set("/a/k=7", "option");
    CHECK(pointer_and_reason([&] { source.fail("/a/k", "it is wrong"); }) == "/a/k | it is wrong");
    CHECK(pointer_and_reason([] { parsed(R"({"a": 1, "a": 2})"); }) ==
          "/a | the key \"a\" is given twice; first at f:1:2 (/)");
    CHECK(pointer_and_reason([] { parsed("{} 3"); }).starts_with(" | "));
}
