// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the boundaries of a case file.

#pragma once

#include "granular/case/object_reader.hpp"

namespace hilda::granular {

struct NamedBoundary {
    std::string name;
    Boundary boundary;
    BoundaryMotion motion = {};  ///< prescribed motion and load; the boundary number is not set
};

/// Reads one entry of `boundaries`. Returns one boundary, or the sides of a box, which are planes with the
/// names NAME-x, NAME+x, NAME-y, ... Throws io::InvalidInput.
std::vector<NamedBoundary> read_boundary(ObjectReader& o, const std::string& name);

}  // namespace hilda::granular
