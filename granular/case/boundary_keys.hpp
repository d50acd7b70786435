// SPDX-License-Identifier: GPL-3.0-or-later
/// The boundaries of a case file.

#pragma once

#include "granular/keys.hpp"

namespace hilda::granular {

struct NamedBoundary {
    std::string name;
    Boundary boundary;
    Motion motion = {};  ///< formulas that it has; without its number
};

/// One, or the sides of a box, named NAME-x, NAME+x, NAME-y, ... after where they are. InvalidCase.
std::vector<NamedBoundary> read_boundary(Keys& keys, const std::string& name, const Compile& compile);

}  // namespace hilda::granular
