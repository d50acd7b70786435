// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda-granular laws.

#pragma once

#include <string>

namespace hilda::granular {

/// A table of the force laws of this program: kind, name and description
std::string list_of_laws();

}  // namespace hilda::granular
