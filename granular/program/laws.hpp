// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda-granular laws.

#pragma once

#include "io/json.hpp"

#include <string>

namespace hilda::granular {

/// A table of the force laws of this program: kind, name and description
std::string list_of_laws();

/// The same for programs: a list of {"kind", "name", "description", "is_default"}
io::Json laws_as_json();

}  // namespace hilda::granular
