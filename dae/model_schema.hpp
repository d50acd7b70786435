// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of model files.

#pragma once

#include "io/json.hpp"

namespace hilda::dae {

/// The schema (JSON Schema, draft 2020-12) of the model files that this program reads: the committed file
/// dae/model.schema.json, in which the definitions of constraints and forces are those of the registered
/// types, and in which a number can be an expression in a string.
io::Json model_schema();

}  // namespace hilda::dae
