// SPDX-License-Identifier: GPL-3.0-or-later
/// What the schema of a file says about a type of objects besides the keys, which come from its reader.

#pragma once

#include "io/registry.hpp"
#include "io/schema/schema_recorder.hpp"

#include <string>
#include <vector>

namespace hilda::io {

/// A type: a joint, a force, an output, a surface, a boundary, a law
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

/// The registered type that the key of the kind names. Notes for the schema that o is of it, with the
/// definition PREFIX NAME.
template <class Type>
const Type& read_type(ObjectReader& o, const TypeKind& kind, const std::string& prefix = "")
{
    const Type& type = *Registry<Type>::find(o.one_of(kind.key, Registry<Type>::names()));
    defines_type(o, kind, prefix + type.name, type.name, type.schema);
    return type;
}

/// Reads the examples of a type for the schema: `read` is called with a Reader of each of them.
template <class Reader, class Read>
void record_examples(SchemaRecorder& recorder, const TypeKind& kind, const std::string& definition,
                     const std::string& name, const TypeSchema& schema, const Read& read)
{
    for (const std::string& example : schema.examples) {
        const std::string text = example_text(kind.key, name, example);
        JsonSource source(text, "example of " + name, text.size() + 1);
        source.schema = &recorder;
        Reader o(source, source.root, "");
        o.find(kind.key);
        defines_type(o, kind, definition, name, schema);
        read(o);
        o.finish();
        recorder.definition(definition)->examples.push_back(source.root);
    }
}

/// Adds the definition of objects of several types, each with a definition PREFIX TYPE.
void add_choice(Json& definitions, const std::string& name, const std::string& title,
                const std::string& description, const std::vector<std::string>& types,
                const std::string& prefix = "");

}  // namespace hilda::io
