// SPDX-License-Identifier: GPL-3.0-or-later
/// The part of the schema of model files that describes one type: a joint, a force, a surface, a law.

#pragma once

#include "io/registry.hpp"

#include <string>
#include <vector>

namespace hilda::io {
class Json;
}

namespace hilda::dae {

/// A key of a type. definition() makes "NAME": {"description": DESCRIPTION, REST} of it.
struct KeySchema {
    std::string name, description;
    std::string rest;       ///< further members of the JSON object: type, limits, default, examples
    bool required = false;  ///< whether every object of the type has the key
};

/// The key "note" of types without a part that has it
inline const KeySchema note_key = {"note", "", R"("$ref": "#/$defs/note")"};

/// Schema of the objects of one type
struct TypeSchema {
    std::string description;  ///< complete sentences; of a constraint, with the number of rows
    /// Shared definitions of dae/model.schema.json: "points", "axes", "derivatives" of constraints, "pose" of
    /// surfaces. Constraints and forces have the part "pair" besides, unless they have "on_one_body".
    std::vector<std::string> parts = {};
    std::vector<KeySchema> keys = {};  ///< the keys besides those of `parts` and the key with the name
    std::string example = {};          ///< members of a JSON object, without the key with the name
    std::string rest = {};             ///< further members of the definition: conditions on several keys
};

/// What the types of one kind have in common in the schema
struct TypeKind {
    std::string title;  ///< "Surface"
    std::string key;    ///< with the name: "type"
    std::string what;   ///< description of this key: "Type of the surface."
};

/// The definition of one type. Throws io::PlacedError for a text of the schema that is not JSON.
io::Json definition(const TypeKind& kind, const std::string& name, const TypeSchema& schema);

/// Definitions of another room: `add` adds those of its registered types to "$defs" of the schema. Registered by
/// io::Registry<SchemaPart>::add().
struct SchemaPart {
    std::string name;
    void (*add)(io::Json& definitions);
};

}  // namespace hilda::dae
