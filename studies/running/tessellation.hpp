// SPDX-License-Identifier: GPL-3.0-or-later
/// Surfaces as polygons, to be looked at.

#pragma once

#include "contact/surface.hpp"

#include <vector>

namespace hilda::studies {

struct Mesh {
    std::vector<lie::Vec3> point;           ///< [m]
    std::vector<std::vector<int>> polygon;  ///< counterclockwise where seen from outside the body

    bool operator==(const Mesh&) const = default;
};

/// How much of a surface without end is wanted
struct Reach {
    Eigen::AlignedBox3d box = {};  ///< what the others visit, in the frame of the surface; may be empty
    double motion = 0;             ///< the size of all that moves [m], by which a Foot is drawn
};

/// Whether a reach has a say: for a plane, a foot, a cylinder, and what no ray from its origin leaves
bool endless(const contact::Surface& surface);

/// In the frame of the surface; a few hundred points. A convex surface by its support, so that it is fine where it
/// is curved; one that is a formula along rays from its origin, or over z = 0 of its frame where it has no end.
/// A mesh is drawn as its triangles. What cannot be found is left open.
Mesh tessellated(const contact::Surface& surface, const Reach& reach);

}  // namespace hilda::studies
