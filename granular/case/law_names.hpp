// SPDX-License-Identifier: GPL-3.0-or-later
/// The names of the force laws.

#pragma once

#include <string>
#include <vector>

namespace hilda::granular {

/// The names of the laws of a kind, which is a key of the case file: normal, tangential, rolling, spin or
/// cohesion
std::vector<std::string> law_names(const std::string& kind);

}  // namespace hilda::granular
