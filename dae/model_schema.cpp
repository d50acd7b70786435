// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of model files, with the registered types.
#include "dae/model_schema.hpp"

#include "dae/force.hpp"
#include "dae/model_types.hpp"
#include "dae/outputs/output.hpp"

#include <algorithm>

namespace hilda::dae {

extern const char model_schema_text[];  // made of model.schema.json by CMake

namespace {

/// Replaces the definitions of one kind by those of the registered types.
template <class Type>
void set_definitions(io::Json& definitions, const std::string& title, const std::string& kind)
{
    io::set_one_of<Type>(definitions, "any_" + kind, [&](const Type& type) {
        TypeSchema schema = type.schema;
        const auto has_part = [&](const char* part) {
            return std::count(schema.parts.begin(), schema.parts.end(), part) > 0;
        };
        if (!has_part("on_one_body") && !has_part("named")) schema.parts.insert(schema.parts.begin(), "pair");
        return definition({title, "type", "Type of the " + kind + "."}, type.name, schema);
    });
}

/// Allows an expression in a string wherever a number is allowed.
void allow_expressions(io::Json& node)
{
    if (auto* list = std::get_if<io::Json::List>(&node.value))
        for (io::Json& element : *list) allow_expressions(element);
    auto* members = std::get_if<io::Json::Object>(&node.value);
    if (members == nullptr) return;
    for (io::Json::Member& m : *members) {
        const std::string* word = m.value.string();
        if (m.key == "type" && word != nullptr && *word == "number")
            m.value = io::Json::List{"number", "string"};
        else if (m.key != "examples" && m.key != "default" && m.key != "const")
            allow_expressions(m.value);
    }
}

}  // namespace

io::Json model_schema()
{
    io::Json schema = io::parsed_schema(model_schema_text, "model.schema.json");
    set_definitions<ConstraintType>(schema["$defs"], "Constraint", "constraint");
    set_definitions<ForceType>(schema["$defs"], "Force", "force");
    set_definitions<OutputType>(schema["$defs"], "Output", "output");
    for (const SchemaPart& part : io::Registry<SchemaPart>::all()) part.add(schema["$defs"]);
    allow_expressions(schema);
    return schema;
}

}  // namespace hilda::dae
