// SPDX-License-Identifier: GPL-3.0-or-later
/// Parts of the schema of model files, from registered types and from other rooms.

#pragma once

#include "io/type_schema.hpp"

namespace hilda::dae {

using io::definition;
using io::KeySchema;
using io::note_key;
using io::TypeKind;
using io::TypeSchema;

/// Definitions of another room: `add` adds those of its registered types to "$defs" of the schema. Registered
/// by io::Registry<SchemaPart>::add().
struct SchemaPart {
    std::string name;
    void (*add)(io::Json& definitions);
};

}  // namespace hilda::dae
