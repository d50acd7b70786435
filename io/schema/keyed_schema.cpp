// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/schema/keyed_schema.hpp"

#include "io/schema/schema_recorder.hpp"

namespace hilda::io {

namespace {

/// The object with these members
Json object(const std::string& members, const std::string& name)
{
    return parsed_schema("{" + members + "}", name);
}

}  // namespace

Json definition(const TypeKind& kind, const std::string& name, const KeyedSchema& schema)
{
    const std::string place = "schema of " + name;
    Json parts = Json::array(), required = Json::array(), properties = Json::object();
    for (const std::string& part : schema.parts) parts.push_back({{"$ref", "#/$defs/" + part}});
    properties[kind.key] = {{"description", kind.what}, {"const", name}};
    for (const KeySchema& key : schema.keys) {
        properties[key.name] = Json::object();
        if (!key.description.empty()) properties[key.name]["description"] = key.description;
        properties[key.name].update(object(key.rest, place + ", key " + key.name));
        if (key.required) required.push_back(key.name);
    }
    Json all = {{"title", kind.title + " " + name}, {"description", schema.description}};
    if (parts.size() > 0) all["allOf"] = parts;
    if (required.size() > 0) all["required"] = required;
    all["properties"] = properties;
    all.update(object(schema.rest, place));
    all["unevaluatedProperties"] = false;
    Json example = {{kind.key, name}};
    example.update(object(schema.example, place + ", example"));
    all["examples"] = Json::array();
    all["examples"].push_back(example);
    return all;
}

}  // namespace hilda::io
