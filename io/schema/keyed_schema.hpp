// SPDX-License-Identifier: GPL-3.0-or-later
/// The part of the schema of cases that describes one type: a law, a boundary, a fill.

#pragma once

#include "io/json.hpp"
#include "io/registry.hpp"
#include "io/schema/type_schema.hpp"

namespace hilda::io {

/// A key of a type. definition() makes "NAME": {"description": DESCRIPTION, REST} of it.
struct KeySchema {
    std::string name, description;
    std::string rest;       ///< further members of the JSON object: type, limits, default, examples
    bool required = false;  ///< whether every object of the type has the key
};

/// The key "note" of types without a part that has it
inline const KeySchema note_key = {"note", "", R"("$ref": "#/$defs/note")"};

/// Schema of the objects of one type
struct KeyedSchema {
    std::string description;  ///< complete sentences
    /// Shared definitions of the schema, such as "boundary_keys"
    std::vector<std::string> parts = {};
    std::vector<KeySchema> keys = {};  ///< the keys besides those of `parts` and the key with the name
    std::string example = {};          ///< members of a JSON object, without the key with the name
    std::string rest = {};             ///< further members of the definition: conditions on several keys
};

/// The definition of one type. Throws PlacedError for a text of the schema that is not JSON.
Json definition(const TypeKind& kind, const std::string& name, const KeyedSchema& schema);

/// Defines the registered types, and `group` as one of them. `definition_of` makes the definition of a type.
template <class Type, class F>
void set_one_of(Json& definitions, const std::string& group, const F& definition_of)
{
    Json references = Json::array();
    for (const Type& type : Registry<Type>::all()) {
        references.push_back({{"$ref", "#/$defs/" + type.name}});
        definitions[type.name] = definition_of(type);
    }
    definitions[group]["oneOf"] = references;
}

/// The same for types with a member `schema`
template <class Type>
void set_one_of(Json& definitions, const std::string& group, const TypeKind& kind)
{
    set_one_of<Type>(definitions, group,
                     [&](const Type& type) { return definition(kind, type.name, type.schema); });
}

}  // namespace hilda::io
