// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of case files.

#pragma once

#include "io/json.hpp"

namespace hilda::granular {

/// The schema (JSON Schema, draft 2020-12) of the cases that this program reads: the committed file
/// granular/case.schema.json, in which the definitions of laws, boundaries and fills are those of the
/// program.
io::Json case_schema();

}  // namespace hilda::granular
