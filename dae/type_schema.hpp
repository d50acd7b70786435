// SPDX-License-Identifier: GPL-3.0-or-later
/// What the schema of model files says about a type of objects besides the keys, which come from its reader.

#pragma once

#include "dae/object_reader.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::io {
class SchemaRecorder;
}

namespace hilda::dae {

/// A type: a joint, a force, an output, a surface, a law
struct TypeSchema {
    std::string description;  ///< complete sentences; of a constraint, with the number of rows
    /// Members of a JSON object, without the key with the name of the type. The schema has the keys that the
    /// reader of the type reads of them.
    std::vector<std::string> examples;
    std::string rest = {};  ///< further members of the definition in JSON: conditions on several keys
};

/// What the types of one kind have in common in the schema
struct TypeKind {
    std::string title;  ///< "Surface"
    std::string key;    ///< with the name of the type: "type"
    std::string what;   ///< description of this key: "Type of the surface."
};

/// {"KEY": "NAME", EXAMPLE}: the object of an example
std::string example_text(const std::string& key, const std::string& name, const std::string& example);

/// Notes for the schema that o is an object of this type, after the key with its name has been read.
void defines_type(ObjectReader& o, const TypeKind& kind, const std::string& definition,
                  const std::string& name, const TypeSchema& schema);

/// Reads the examples of a type for the schema: `read` is called with each of them.
void record_examples(io::SchemaRecorder& recorder, const TypeKind& kind, const std::string& definition,
                     const std::string& name, const TypeSchema& schema,
                     const std::function<void(ObjectReader&)>& read);

/// The schema of another room. Registered by io::Registry<SchemaPart>::add().
struct SchemaPart {
    std::string name;
    std::vector<std::string> models;               ///< examples of model files
    void (*record)(io::SchemaRecorder& recorder);  ///< reads the examples of its registered types
    void (*add)(io::Json& definitions);            ///< adds what selects among them to "$defs" of the schema
};

}  // namespace hilda::dae
