// SPDX-License-Identifier: GPL-3.0-or-later
/// Tools that will fall through a plane, because boundaries do not touch each other.

#pragma once

#include "granular/world/world.hpp"

namespace hilda::granular {

struct FallingTool {
    int boundary;      ///< number of the tool
    std::string text;  ///< of the warning
};

/// The tools whose weight and constant external force pull them towards a plane, with no particle between
/// them. `names`: of the boundaries
std::vector<FallingTool> falling_tools(const World& world, const std::vector<std::string>& names,
                                       const Vec3& gravity);

}  // namespace hilda::granular
