// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of model files.

#pragma once

#include "io/json.hpp"

#include <string>
#include <vector>

namespace hilda::io {
class SchemaRecorder;
}

namespace hilda::dae {

/// The schema (JSON Schema, draft 2020-12) of the model files that this program reads. It is recorded from
/// the readers, which read the examples of all registered types.
io::Json model_schema();

/// The schema of another room. Registered by io::Registry<SchemaPart>::add().
struct SchemaPart {
    std::string name;
    std::vector<std::string> models;               ///< examples of model files
    void (*record)(io::SchemaRecorder& recorder);  ///< reads the examples of its registered types
    void (*add)(io::Json& definitions);            ///< adds what selects among them to "$defs" of the schema
};

}  // namespace hilda::dae
