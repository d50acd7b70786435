// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/schema/keyed_schema.hpp"

#include "io/json_source.hpp"
#include "io/schema/schema_recorder.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

TEST_CASE("the schema of a type has its name, keys, parts, conditions and example", "[io][schema]")
{
    const io::TypeKind kind = {"Spring", "type", "Type of the spring."};
    const io::KeyedSchema schema = {
        .description = "A spring.",
        .parts = {"points", "pair"},
        .keys = {{"k", "Stiffness [N/m].", R"("type": "number", "minimum": 0)", true},
                 {"c", "", R"("$ref": "#/$defs/c")"}},
        .example = R"("k": 3)",
        .rest = R"("if": {"required": ["c"]})"};
    const std::string expected = R"({
        "title": "Spring coil", "description": "A spring.",
        "allOf": [{"$ref": "#/$defs/points"}, {"$ref": "#/$defs/pair"}], "required": ["k"],
        "properties": {"type": {"description": "Type of the spring.", "const": "coil"},
                       "k": {"description": "Stiffness [N/m].", "type": "number", "minimum": 0},
                       "c": {"$ref": "#/$defs/c"}},
        "if": {"required": ["c"]}, "unevaluatedProperties": false, "examples": [{"type": "coil", "k": 3}]})";
    CHECK(io::written(io::definition(kind, "coil", schema)) ==
          io::written(io::parsed_schema(expected, "expected")));

    const std::string bare = R"({"title": "Spring none", "description": "No spring.",
        "properties": {"type": {"description": "Type of the spring.", "const": "none"}},
        "unevaluatedProperties": false, "examples": [{"type": "none"}]})";
    CHECK(io::written(io::definition(kind, "none", {.description = "No spring."})) ==
          io::written(io::parsed_schema(bare, "expected")));
}

TEST_CASE("a text of a schema that is not JSON is refused with the type and the key", "[io][schema]")
{
    const io::TypeKind kind = {"Spring", "type", "Type of the spring."};
    CHECK_THROWS_WITH(
        io::definition(kind, "coil", {.description = "", .keys = {{"k", "", R"("type": number)"}}}),
        Catch::StartsWith("schema of coil, key k:1:") && Catch::Contains("not JSON"));
    CHECK_THROWS_WITH(io::definition(kind, "coil", {.description = "", .example = "k"}),
                      Catch::StartsWith("schema of coil, example:1:"));
    CHECK_THROWS_WITH(io::definition(kind, "coil", {.description = "", .rest = "]"}),
                      Catch::StartsWith("schema of coil:1:"));
}
