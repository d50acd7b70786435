// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of model files, with the registered types.
#include "dae/model_schema.hpp"

#include "dae/force.hpp"
#include "dae/model_types.hpp"
#include "io/json_source.hpp"

#include <algorithm>
#include <cctype>

namespace hilda::dae {

extern const char model_schema_text[];  // made of model.schema.json by CMake

namespace {

io::Json parsed(const std::string& text, const std::string& name)
{
    return io::JsonSource(text, name, text.size() + 1).root;
}

/// The definition of one type. `kind` is "constraint" or "force".
io::Json definition(const std::string& kind, const std::string& name, const TypeSchema& schema)
{
    std::string title = kind;
    title[0] = static_cast<char>(std::toupper(title[0]));
    io::Json parts = io::Json::array(), required = io::Json::array(), properties = io::Json::object();
    const bool on_one_body = std::count(schema.parts.begin(), schema.parts.end(), "on_one_body") > 0;
    if (!on_one_body) parts.push_back({{"$ref", "#/$defs/pair"}});
    for (const std::string& part : schema.parts) parts.push_back({{"$ref", "#/$defs/" + part}});
    properties["type"] = {{"description", "Type of the " + kind + "."}, {"const", name}};
    for (const KeySchema& key : schema.keys) {
        properties[key.name] = {{"description", key.description}};
        properties[key.name].update(parsed("{" + key.rest + "}", "schema of " + name + ", key " + key.name));
        if (key.required) required.push_back(key.name);
    }
    io::Json all = {{"title", title + " " + name}, {"description", schema.description}, {"allOf", parts}};
    if (required.size() > 0) all["required"] = required;
    all["properties"] = properties;
    all["unevaluatedProperties"] = false;
    io::Json example = {{"type", name}};
    example.update(parsed("{" + schema.example + "}", "schema of " + name + ", example"));
    all["examples"] = io::Json::array();
    all["examples"].push_back(example);
    return all;
}

/// Replaces the definitions of one kind by those of the registered types.
template <class Type>
void set_definitions(io::Json& definitions, const std::string& kind)
{
    io::Json references = io::Json::array();
    for (const Type& type : io::Registry<Type>::all()) {
        references.push_back({{"$ref", "#/$defs/" + type.name}});
        definitions[type.name] = definition(kind, type.name, type.schema);
    }
    definitions["any_" + kind]["oneOf"] = references;
}

}  // namespace

io::Json model_schema()
{
    io::Json schema = parsed(model_schema_text, "model.schema.json");
    set_definitions<ConstraintType>(schema["$defs"], "constraint");
    set_definitions<ForceType>(schema["$defs"], "force");
    return schema;
}

}  // namespace hilda::dae
