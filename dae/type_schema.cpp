// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/type_schema.hpp"

#include "io/json_source.hpp"

namespace hilda::dae {

namespace {

/// The object with these members
io::Json object(const std::string& members, const std::string& name)
{
    const std::string text = "{" + members + "}";
    return io::JsonSource(text, name, text.size() + 1).root;
}

}  // namespace

io::Json definition(const TypeKind& kind, const std::string& name, const TypeSchema& schema)
{
    const std::string place = "schema of " + name;
    io::Json parts = io::Json::array(), required = io::Json::array(), properties = io::Json::object();
    for (const std::string& part : schema.parts) parts.push_back({{"$ref", "#/$defs/" + part}});
    properties[kind.key] = {{"description", kind.what}, {"const", name}};
    for (const KeySchema& key : schema.keys) {
        properties[key.name] = io::Json::object();
        if (!key.description.empty()) properties[key.name]["description"] = key.description;
        properties[key.name].update(object(key.rest, place + ", key " + key.name));
        if (key.required) required.push_back(key.name);
    }
    io::Json all = {{"title", kind.title + " " + name}, {"description", schema.description}};
    if (parts.size() > 0) all["allOf"] = parts;
    if (required.size() > 0) all["required"] = required;
    all["properties"] = properties;
    all.update(object(schema.rest, place));
    all["unevaluatedProperties"] = false;
    io::Json example = {{kind.key, name}};
    example.update(object(schema.example, place + ", example"));
    all["examples"] = io::Json::array();
    all["examples"].push_back(example);
    return all;
}

}  // namespace hilda::dae
