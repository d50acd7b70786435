// SPDX-License-Identifier: GPL-3.0-or-later
/// The JSON schema of case files.

#pragma once

#include "io/json.hpp"

namespace hilda::granular {

/// The schema (JSON Schema, draft 2020-12) of the cases that this program reads. It is recorded from the
/// readers, which read examples of all registered types and of all laws.
io::Json case_schema();

}  // namespace hilda::granular
