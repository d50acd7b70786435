// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/object_reader.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

namespace {

/// Message of reading the value of the key "x"; "" if it is read
template <class Read>
std::string refusal_of_text(const std::string& text, const Read& read)
{
    const io::JsonSource source(text, "f");
    try {
        io::ObjectReader o(source, source.root, "");
        read(o);
        o.finish();
        return "";
    } catch (const io::PlacedError& e) {
        return e.what();
    }
}

}  // namespace

TEST_CASE("a reader refuses other types and values outside the range with their place", "[io][object_reader]")
{
    const auto number = [](io::ObjectReader& o) { o.number("x"); };
    const auto positive = [](io::ObjectReader& o) { o.positive("x"); };
    const auto count = [](io::ObjectReader& o) { o.count("x"); };
    const auto fraction = [](io::ObjectReader& o) { o.fraction("x"); };
    const auto word = [](io::ObjectReader& o) { o.one_of("x", {"plane", "sphere"}); };
    const auto three = [](io::ObjectReader& o) { o.numbers("x", 3); };
    const auto formulas = [](io::ObjectReader& o) { o.expressions("x"); };
    CHECK(refusal_of_text("[]", number) == "f:1:1 (/): must be an object, got []");
    CHECK(refusal_of_text("{}", number) == "f:1:1 (/): missing key 'x'");
    CHECK(refusal_of_text(R"({"x": "1"})", number) == "f:1:7 (/x): x must be a number, got \"1\"");
    CHECK(refusal_of_text(R"({"x": 0})", positive) == "f:1:7 (/x): x must be positive, got 0");
    CHECK(refusal_of_text(R"({"x": -1})", count) ==
          "f:1:7 (/x): x must be an integer from 0 to 2^53, got -1");
    CHECK(refusal_of_text(R"({"x": 1.5})", count) ==
          "f:1:7 (/x): x must be an integer from 0 to 2^53, got 1.5");
    CHECK(refusal_of_text(R"({"x": 9007199254740991})", count).empty());
    CHECK(refusal_of_text(R"({"x": 7})", fraction) == "f:1:7 (/x): x must be from 0 to 1, got 7");
    CHECK(refusal_of_text(R"({"x": "plan"})", word) ==
          "f:1:7 (/x): unknown x \"plan\"; did you mean 'plane'?");
    CHECK(refusal_of_text(R"({"x": "torus"})", word) ==
          "f:1:7 (/x): unknown x \"torus\"; allowed: plane, sphere");
    CHECK(refusal_of_text(R"({"x": [1, 2]})", three) ==
          "f:1:7 (/x): x must be a list of 3 numbers, got [1, 2]");
    CHECK(refusal_of_text(R"({"x": [1, 2, true]})", three) == "f:1:14 (/x/2): x must be a number, got true");
    CHECK(refusal_of_text("{\"x\": [1, \"t\", \"sine(t)\"]}", formulas) ==
          "f:1:16 (/x/2): unknown function 'sine' in \"sine(t)\" at column 1; did you mean 'sin'?");
    CHECK(refusal_of_text(R"({"x": [1, "t", null]})", formulas) ==
          "f:1:16 (/x/2): a component must be a number or an expression in a string, got null");
    CHECK(refusal_of_text(R"({"x": 1, "xx": 2, "note": "n"})", number) ==
          "f:1:10 (/xx): unknown key \"xx\"; did you mean 'x'?");
    CHECK(refusal_of_text(R"({"x": 1, "note": "any object may have one"})", number).empty());
}

TEST_CASE("the schema that an editor uses may be named in the root object", "[io][object_reader]")
{
    const auto root = [](io::ObjectReader& o) { o.allow_schema(); };
    CHECK(refusal_of_text(R"({"$schema": "../case.schema.json"})", root).empty());
    CHECK(refusal_of_text("{}", root).empty());
    CHECK(refusal_of_text(R"({"$schema": 1})", root) == "f:1:13 (/$schema): $schema must be a string, got 1");
    CHECK(refusal_of_text(R"({"$schema": ""})", [](io::ObjectReader&) {}) ==
          "f:1:2 (/$schema): unknown key \"$schema\"; allowed: note");
}

TEST_CASE("a path in a text is relative to the folder of the text", "[io][object_reader]")
{
    io::JsonSource source(R"({"a": "mesh/s.stl", "b": "/tmp/s.stl", "c": "", "d": 1, "e": "a\nb"})", "f");
    io::ObjectReader in_current_folder(source, source.root, "");
    CHECK(in_current_folder.file("a") == "mesh/s.stl");
    source.base = "models";
    io::ObjectReader o(source, source.root, "");
    CHECK(o.file("a") == "models/mesh/s.stl");
    CHECK(o.file("b") == "/tmp/s.stl");
    for (const char* key : {"c", "d", "e"})
        CHECK_THROWS_WITH(o.file(key),
                          Catch::Contains(std::string(key) + " must be the path of a file, got"));
}

TEST_CASE("a reader refuses integers, texts and formulas that are none", "[io][object_reader]")
{
    const auto integer = [](io::ObjectReader& o) { o.integer("x"); };
    const auto text = [](io::ObjectReader& o) { o.text("x"); };
    const auto formula = [](io::ObjectReader& o) { o.formula("x", {}, {}, {"t"}); };
    const auto of_names = [](io::ObjectReader& o) { o.formula_of_names("x", {"t"}); };
    CHECK(refusal_of_text(R"({"x": -2147483647})", integer).empty());
    CHECK(refusal_of_text(R"({"x": "1"})", integer) == "f:1:7 (/x): x must be a number, got \"1\"");
    CHECK(refusal_of_text(R"({"x": 1.5})", integer) ==
          "f:1:7 (/x): x must be an integer of at most 31 bits, got 1.5");
    CHECK(refusal_of_text(R"({"x": 2147483648})", integer) ==
          "f:1:7 (/x): x must be an integer of at most 31 bits, got 2147483648");
    CHECK(refusal_of_text("{}", text) == "f:1:1 (/): missing key 'x'");
    CHECK(refusal_of_text(R"({"x": 1})", text) == "f:1:7 (/x): x must be a string, got 1");
    CHECK(refusal_of_text("{\"x\": \"" + std::string(io::JsonSource::max_string, 'a') + "\"}", text).empty());
    CHECK(refusal_of_text(R"({"x": 2})", formula).empty());
    CHECK(refusal_of_text(R"({"x": "t^2"})", formula).empty());
    CHECK(refusal_of_text(R"({"x": [1]})", formula) ==
          "f:1:7 (/x): x must be a number or an expression in a string, got [1]");
    CHECK(refusal_of_text(R"({"x": ""})", of_names) == "f:1:7 (/x): x must be an expression, got \"\"");
    CHECK(refusal_of_text(R"({"x": 1})", of_names) == "f:1:7 (/x): x must be a string, got 1");

    const io::JsonSource source(R"({"x": 2})", "f");
    io::ObjectReader o(source, source.root, "");
    CHECK(o.formula("x", {}, {}, {"t"}) == "2");
    CHECK(o.formula("y", {}, "t", {"t"}) == "t");
}

TEST_CASE("a file of another kind is refused with the command for it", "[io][object_reader]")
{
    const auto model = [](io::ObjectReader& o) { o.version("hilda_model"); };
    const auto cosim = [](io::ObjectReader& o) { o.version("hilda_cosim"); };
    CHECK(refusal_of_text(R"({"hilda_model": 1})", model).empty());
    CHECK(refusal_of_text(R"({"hilda_model": 2})", model) ==
          "f:1:17 (/hilda_model): the version of the format must be 1, got 2");
    CHECK(refusal_of_text(R"({"hilda_case": 1})", model) ==
          "f:1:16 (/hilda_case): the file is a case of grains, not a model; use hilda granular");
    CHECK(refusal_of_text(R"({"hilda_cosim": 1})", model) ==
          "f:1:17 (/hilda_cosim): the file is a co-simulation, not a model; use hilda cosim");
    CHECK(refusal_of_text(R"({"hilda_model": 1})", cosim) ==
          "f:1:17 (/hilda_model): the file is a model, not a co-simulation; use hilda run");
    CHECK(refusal_of_text("{}", model) == "f:1:1 (/): missing key 'hilda_model'");
    const io::JsonSource source("{}", "f");
    io::ObjectReader(source, source.root, "").refuse_other_kinds("hilda_model");
}
