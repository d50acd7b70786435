// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/schema/type_schema.hpp"

#include "io/registry.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

namespace {

struct Spring {
    std::string name;
    io::TypeSchema schema;
};
const io::TypeKind kind = {"Spring", "type", "Type of the spring."};
const bool registered_springs =
    io::Registry<Spring>::add({"coil",
                               {.description = "A coil.",
                                .examples = {R"("k": 3)", R"("k": 4, "c": 1)"},
                                .rest = R"("if": {"required": ["c"]})"}}) &&
    io::Registry<Spring>::add({"none", {.description = "No spring.", .examples = {""}}});

void read_spring(io::ObjectReader& o)
{
    o.positive("k", {"Stiffness [N/m].", "2"});
    if (o.has("c")) o.number("c", {"Damping [N s/m].", "1"});
}

}  // namespace

TEST_CASE("the definition of a type has its name, the keys of all examples, its conditions and its examples",
          "[io][schema]")
{
    io::SchemaRecorder recorder;
    const io::TypeSchema& schema = io::Registry<Spring>::find("coil")->schema;
    io::record_examples<io::ObjectReader>(recorder, kind, "spring_coil", "coil", schema, read_spring);
    recorder.definition("root");
    const std::string expected = R"({"title": "Spring coil", "description": "A coil.", "type": "object",
        "required": ["k"], "properties": {
        "type": {"description": "Type of the spring.", "const": "coil"},
        "k": {"description": "Stiffness [N/m].", "type": "number", "exclusiveMinimum": 0, "examples": [2]},
        "c": {"description": "Damping [N s/m].", "type": "number", "examples": [1]},
        "note": {"$ref": "#/$defs/note"}}, "if": {"required": ["c"]}, "additionalProperties": false,
        "examples": [{"type": "coil", "k": 3}, {"type": "coil", "k": 4, "c": 1}]})";
    const io::Json all = recorder.schema("root");
    CHECK(io::written(all.member("$defs")->value.member("spring_coil")->value) ==
          io::written(io::parsed_schema(expected, "expected")));
}

TEST_CASE("a type is found by the value of its key, and its object has the definition of the type",
          "[io][schema]")
{
    io::SchemaRecorder recorder;
    for (const char* name : {"coil", "none"}) {
        io::JsonSource source(io::example_text("type", name, ""), "example");
        source.schema = &recorder;
        io::ObjectReader o(source, source.root, "");
        CHECK(io::read_type<Spring>(o, kind, "spring_").name == name);
        o.finish();
        CHECK(recorder.definition(std::string("spring_") + name)->title == std::string("Spring ") + name);
    }
    io::JsonSource source(R"({"type": "leaf"})", "example");
    io::ObjectReader o(source, source.root, "");
    CHECK_THROWS_WITH(io::read_type<Spring>(o, kind), Catch::Contains("unknown type \"leaf\""));
}

TEST_CASE("a text of the schema of a type that is not JSON is refused with the name of the type",
          "[io][schema]")
{
    io::SchemaRecorder recorder;
    const auto record = [&](const io::TypeSchema& schema) {
        io::record_examples<io::ObjectReader>(recorder, kind, "coil", "coil", schema, read_spring);
    };
    CHECK_THROWS_WITH(record({.description = "", .examples = {R"("k": )"}}),
                      Catch::StartsWith("example of coil:1:"));
    CHECK_THROWS_WITH(record({.description = "", .examples = {R"("k": 1)"}, .rest = "]"}),
                      Catch::StartsWith("schema of Spring coil:1:"));
}

TEST_CASE("a choice among types has a reference for each of them", "[io][schema]")
{
    io::Json definitions = io::Json::object();
    io::add_choice(definitions, "spring", "Spring", "A spring.", io::Registry<Spring>::names(), "spring_");
    CHECK(io::written(definitions) ==
          io::written(io::parsed_schema(R"({"spring": {"title": "Spring", "description": "A spring.",
              "type": "object", "required": ["type"],
              "oneOf": [{"$ref": "#/$defs/spring_coil"}, {"$ref": "#/$defs/spring_none"}]}})",
                                        "expected")));
}
