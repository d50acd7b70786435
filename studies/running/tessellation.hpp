// SPDX-License-Identifier: GPL-3.0-or-later
/// Approximation of surfaces by polygons, for visualisation.

#pragma once

#include "contact/surface.hpp"

#include <vector>

namespace hilda::studies {

struct Mesh {
    std::vector<lie::Vec3> point;           ///< [m]
    std::vector<std::vector<int>> polygon;  ///< vertices, counterclockwise seen from outside the body

    bool operator==(const Mesh&) const = default;
};

/// The part of an unbounded surface that is drawn
struct DrawingExtent {
    Eigen::AlignedBox3d box =
        {};                 ///< region of the other bodies, in the frame of the surface [m]; may be empty
    double scene_size = 0;  ///< diagonal of the region of all bodies [m]; sets the size of a Foot
};

/// True for a surface that is drawn by an extent: plane, foot, cylinder, height map, and an implicit surface
/// with a coordinate half-axis that does not intersect it
bool is_unbounded(const contact::Surface& surface);

/// Polygons of a surface, in the frame of the surface; at most about 500 points, except for a mesh, whose
/// triangles are used. A convex surface is sampled by its support function, which places the points by normal
/// direction. An implicit surface is sampled along rays from its origin, an unbounded one by projection of
/// points of the plane z = 0. Points that are not found are left out together with their polygons.
Mesh tessellate(const contact::Surface& surface, const DrawingExtent& extent);

}  // namespace hilda::studies
