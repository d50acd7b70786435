// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/schema/schema_recorder.hpp"

#include <algorithm>

namespace hilda::io {

Json parsed_schema(const std::string& text, const std::string& name)
{
    return JsonSource(text, name, text.size() + 1).root;
}

void ObjectSchema::begin()
{
    end();
    ++objects;
    for (Key& k : keys) k.now = Key::Now::absent;
}

void ObjectSchema::end()
{
    for (Key& k : keys) k.required = k.required && k.now == Key::Now::required;
}

void ObjectSchema::add_example(const Json& object)
{
    for (const Json& known : *examples.list())
        if (written(known) == written(object)) return;
    examples.push_back(object);
}

ObjectSchema::Key& ObjectSchema::key(std::string_view name)
{
    const auto at = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == name; });
    if (at != keys.end()) return *at;
    keys.push_back({.name = std::string(name)});
    keys.back().required = objects <= 1;
    return keys.back();
}

void ObjectSchema::seen(std::string_view name, bool required)
{
    Key& k = key(name);
    if (k.now != Key::Now::optional) k.now = required ? Key::Now::required : Key::Now::optional;
}

void ObjectSchema::describe(std::string_view name, Json schema, Json example)
{
    Key& k = key(name);
    // The first description stays. A call without one is a further look at the key.
    if (k.schema.member("description") != nullptr) return;
    if (schema.member("description") == nullptr && k.schema.size() > 0) return;
    k.schema = std::move(schema), k.example = std::move(example);
}

void ObjectSchema::exclude(const std::string& one, const std::string& other)
{
    const std::pair both(one, other);
    if (std::find(exclusive.begin(), exclusive.end(), both) == exclusive.end()) exclusive.push_back(both);
}

std::shared_ptr<ObjectSchema> ObjectSchema::inner(std::string_view name)
{
    Key& k = key(name);
    if (k.inner == nullptr) k.inner = std::make_shared<ObjectSchema>(recorder);
    k.inner->begin();
    return k.inner;
}

const Json* ObjectSchema::example(std::string_view name)
{
    const Key& k = key(name);
    return std::holds_alternative<std::nullptr_t>(k.example.value) ? nullptr : &k.example;
}

Json ObjectSchema::members()
{
    end();
    Json required = Json::array(), properties = Json::object();
    const auto add = [&](const Key& k) {
        if (k.schema.size() == 0) return;
        properties[k.name] = k.schema;
        if (k.inner != nullptr) properties[k.name].update(k.inner->members());
        if (k.required) required.push_back(k.name);
    };
    // The free text is the last key.
    for (const Key& k : keys)
        if (k.name != "note") add(k);
    for (const Key& k : keys)
        if (k.name == "note") add(k);
    Json all = Json::object();
    if (required.size() > 0) all["required"] = required;
    all["properties"] = properties;
    all.update(rest);
    for (const auto& [one, other] : exclusive)
        all["allOf"].push_back({{"not", {{"required", Json::List{one, other}}}}});
    if (!open) all["additionalProperties"] = false;
    return all;
}

SchemaRecorder::SchemaRecorder()
{
    const auto number = [](const char* range) {
        return parsed_schema(std::string(R"({"type": "number")") + range + "}", "kind of values");
    };
    kinds = {{"number", number("")},
             {"positive", number(R"(, "exclusiveMinimum": 0)")},
             {"not_negative", number(R"(, "minimum": 0)")},
             {"fraction", number(R"(, "minimum": 0, "maximum": 1)")},
             {"integer", {{"type", "integer"}}},
             {"count", {{"type", "integer"}, {"minimum", 0}}},
             {"flag", {{"type", "boolean"}}},
             {"text", {{"type", "string"}}}};
    for (const char* name : {"name", "note", "formula", "vector", "matrix", "direction"})
        kinds[name] = {{"$ref", std::string("#/$defs/") + name}};
    kinds["file"] = {{"type", "string"}, {"minLength", 1}};
    kinds["formula_of_names"] = {{"type", "string"}, {"minLength", 1}, {"maxLength", JsonSource::max_string}};
}

Json SchemaRecorder::kind(std::string_view name, const std::string& of) const
{
    if (const auto known = kinds.find(name); known != kinds.end()) return known->second;
    return parsed_schema('{' + std::string(name) + '}', of);
}

std::shared_ptr<ObjectSchema> SchemaRecorder::definition(const std::string& name)
{
    for (const auto& [known, schema] : all)
        if (known == name) return schema;
    return all.emplace_back(name, std::make_shared<ObjectSchema>(*this)).second;
}

Json SchemaRecorder::schema(const std::string& root) const
{
    Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}}, definitions = Json::object();
    for (const auto& [name, object] : all) {
        Json one = Json::object();
        if (!object->title.empty()) one = {{"title", object->title}, {"description", object->description}};
        one["type"] = "object";
        one.update(object->members());
        if (object->examples.size() > 0) one["examples"] = object->examples;
        if (name == root)
            schema.update(one);
        else
            definitions[name] = one;
    }
    schema["$defs"] = definitions;
    return schema;
}

}  // namespace hilda::io
