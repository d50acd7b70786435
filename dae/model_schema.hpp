// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of model files.

#pragma once

#include "io/json.hpp"

namespace hilda::dae {

/// The schema (JSON Schema, draft 2020-12) of the model files that this program reads. It is recorded from
/// the readers, which read the examples of all registered types.
io::Json model_schema();

}  // namespace hilda::dae
