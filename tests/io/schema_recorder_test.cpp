// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/schema/schema_recorder.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

namespace {

/// The members of a definition that `read` makes of the examples
template <class Read>
std::string recorded(const std::vector<std::string>& examples, const Read& read)
{
    io::SchemaRecorder recorder;
    for (const std::string& example : examples) {
        io::JsonSource source(example, "example");
        source.schema = &recorder;
        io::ObjectReader o(source, source.root, "");
        o.defines("thing", "", "");
        read(o);
        o.finish();
    }
    return io::written(recorder.definition("thing")->members());
}

std::string expected(const std::string& properties, const std::string& rest = "")
{
    const std::string note = R"("note": {"$ref": "#/$defs/note"}}, )";
    return io::written(
        io::parsed_schema('{' + properties + note + rest + R"("additionalProperties": false})", "expected"));
}

}  // namespace

TEST_CASE("a schema has the type, range, default and description of each key that is read", "[io][schema]")
{
    const auto read = [](io::ObjectReader& o) {
        o.positive("radius", {"Radius [m].", "0.1"});
        o.not_negative("damping", {"Damping [N s/m].", "3, 4"}, 2);
        o.fraction("e", {"Restitution [-].", "1"}, 0.5);
        o.one_of("frame", {"global", "body"}, {"Frame.", R"("body")"}, "global");
        o.numbers("sides", 2, {"Sides [m].", "[1, 2]"});
        o.number("angle", {"Angle [rad].", "1", R"("maximum": 3)"});
    };
    CHECK(recorded({R"({"radius": 1, "sides": [1, 2], "angle": 2})"}, read) == expected(R"(
        "required": ["radius", "sides", "angle"], "properties": {
        "radius": {"description": "Radius [m].", "type": "number", "exclusiveMinimum": 0, "examples": [0.1]},
        "damping": {"description": "Damping [N s/m].", "type": "number", "minimum": 0, "default": 2,
                    "examples": [3, 4]},
        "e": {"description": "Restitution [-].", "type": "number", "minimum": 0, "maximum": 1, "default": 0.5,
              "examples": [1]},
        "frame": {"description": "Frame.", "enum": ["global", "body"], "default": "global",
                  "examples": ["body"]},
        "sides": {"description": "Sides [m].", "type": "array", "items": {"type": "number"}, "minItems": 2,
                  "maxItems": 2, "examples": [[1, 2]]},
        "angle": {"description": "Angle [rad].", "type": "number", "maximum": 3, "examples": [1]}, )"));
}

TEST_CASE("a key is required if every example was read with it as a required key", "[io][schema]")
{
    const auto read = [](io::ObjectReader& o) {
        if (o.given("force")) o.number("force", {"Force [N].", "5"});
        if (o.has("file"))
            o.text("file", {"File.", R"("a.csv")"});
        else
            o.number("value", {"Value [-].", "1"});
        o.number("always", {"Always [-].", "1"});
    };
    const std::string both = expected(R"("required": ["always"], "properties": {
        "force": {"description": "Force [N].", "type": "number", "examples": [5]},
        "file": {"description": "File.", "type": "string", "examples": ["a.csv"]},
        "always": {"description": "Always [-].", "type": "number", "examples": [1]},
        "value": {"description": "Value [-].", "type": "number", "examples": [1]}, )");
    const std::string with_value = R"({"value": 2, "always": 1})",
                      with_file = R"({"file": "b.csv", "always": 1})";
    CHECK(recorded({with_file, with_value}, read) == both);
    // Without the second example the schema does not know the key of the other branch.
    const std::string one = recorded({with_value}, read);
    CHECK_THAT(one, Catch::Contains(R"("required": ["value", "always"])"));
    CHECK_THAT(one, !Catch::Contains("a.csv"));
}

TEST_CASE("the version of a file is a required key", "[io][schema]")
{
    const auto read = [](io::ObjectReader& o) {
        o.note("hilda_case", R"("const": 1)", {"Version.", "1"});
        o.version("hilda_case");
    };
    CHECK(recorded({R"({"hilda_case": 1})"}, read) == expected(R"("required": ["hilda_case"], "properties": {
        "hilda_case": {"description": "Version.", "const": 1, "examples": [1]}, )"));
}

TEST_CASE("a default that depends on other keys is not in the schema", "[io][schema]")
{
    const auto read = [](io::ObjectReader& o) {
        const double mu_s = o.number("mu_s", {"Static [-].", "1"});
        o.number("mu_k", {.text = "Kinetic [-].", .example = "1", .computed = true}, mu_s);
    };
    CHECK(recorded({R"({"mu_s": 0.3})"}, read) == expected(R"("required": ["mu_s"], "properties": {
        "mu_s": {"description": "Static [-].", "type": "number", "examples": [1]},
        "mu_k": {"description": "Kinetic [-].", "type": "number", "examples": [1]}, )"));
}

TEST_CASE("keys that exclude each other are a condition of the schema", "[io][schema]")
{
    const auto read = [](io::ObjectReader& o) {
        o.note_exclusive(std::vector<std::string>{"a", "b", "c"});
        o.exclude("a", "b");
    };
    CHECK(recorded({"{}"}, read) == expected(R"("properties": {)", R"("allOf": [
        {"not": {"required": ["a", "b"]}}, {"not": {"required": ["a", "c"]}},
        {"not": {"required": ["b", "c"]}}], )"));
}

TEST_CASE("an object under a key has its keys in the schema, or a definition", "[io][schema]")
{
    io::SchemaRecorder recorder;
    recorder.shown = {"part"};
    for (const char* text :
         {R"({"own": {"x": 1}, "other": {"y": 2}})", R"({"own": {"x": 1}, "other": {}})"}) {
        io::JsonSource source(text, "example");
        source.schema = &recorder;
        io::ObjectReader o(source, source.root, "");
        o.defines("root", "Root", "All of it.");
        io::ObjectReader own = o.object("own", {"Own keys.", "{}"});
        own.number("x", {"X [m].", "1"});
        own.finish();
        io::ObjectReader other = o.object("other", {"Another.", "{}"}, "part");
        other.defines("part", "Part", "A part.", R"("minProperties": 0)");
        other.number("y", {"Y [m].", "1"}, 0);
        other.finish();
        o.finish();
    }
    const std::string note = R"("note": {"$ref": "#/$defs/note"})";
    const std::string schema =
        R"({"$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Root", "description": "All of it.", "type": "object", "required": ["own", "other"],
        "properties": {"own": {"description": "Own keys.", "type": "object", "examples": [{}],
            "required": ["x"], "properties": {"x": {"description": "X [m].", "type": "number",
            "examples": [1]}, )" +
        note + R"(}, "additionalProperties": false},
        "other": {"description": "Another.", "$ref": "#/$defs/part", "examples": [{}]}, )" +
        note +
        R"(}, "additionalProperties": false, "$defs": {"part": {"title": "Part", "description": "A part.",
        "type": "object", "properties": {"y": {"description": "Y [m].", "type": "number", "default": 0,
        "examples": [1]}, )" +
        note + R"(}, "minProperties": 0, "additionalProperties": false,
        "examples": [{"y": 2}, {}]}}})";
    CHECK(io::written(recorder.schema("root")) == io::written(io::parsed_schema(schema, "expected")));
}

TEST_CASE("a text of a schema that is not JSON is refused", "[io][schema]")
{
    const auto rest = [](io::ObjectReader& o) { o.number("k", {"K [-].", "1", R"("type": number)"}); };
    CHECK_THROWS_WITH(recorded({R"({"k": 1})"}, rest), Catch::Contains("not JSON"));
    const auto example = [](io::ObjectReader& o) { o.number("k", {"K [-].", "one"}); };
    CHECK_THROWS_WITH(recorded({R"({"k": 1})"}, example), Catch::StartsWith("examples of key k:1:"));
    const auto unknown = [](io::ObjectReader&) {};
    CHECK_THROWS_WITH(recorded({R"({"k": 1})"}, unknown), Catch::Contains("unknown key \"k\""));
}

TEST_CASE("an object that the example omits is read from its own example", "[io][schema]")
{
    const auto read = [](io::ObjectReader& o) {
        io::ObjectReader own = o.object("own", {"Own keys.", R"({"x": 5})"});
        for (const char* key : {"a", "b", "c", "d", "e", "f", "g", "h"})
            o.number(key, {"Number [-].", "1"}, 0);
        CHECK(own.number("x", {"X [m].", "1"}) == 5);
        own.finish();
    };
    CHECK_THAT(recorded({"{}"}, read), Catch::Contains(R"("required": ["own"])"));
}
