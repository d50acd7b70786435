// SPDX-License-Identifier: GPL-3.0-or-later
/// Approximation of surfaces by polygons, for visualisation.

#pragma once

#include "contact/surface.hpp"

#include <Eigen/Geometry>

#include <functional>
#include <vector>

namespace hilda::contact {

struct PolygonMesh {
    std::vector<Vec3> point;                ///< [m]
    std::vector<std::vector<int>> polygon;  ///< vertices, counterclockwise seen from outside the body

    bool operator==(const PolygonMesh&) const = default;
};

/// The part of an unbounded surface that is drawn
struct DrawingExtent {
    /// Region of the other bodies, in the frame of the surface [m]; may be empty
    Eigen::AlignedBox3d box = {};
    double scene_size = 0;  ///< diagonal of the region of all bodies [m]; sets the size of a Foot

    static constexpr double margin = 1.1;  ///< size of the drawn part, relative to the region to be covered
};

/// Polygons of a surface, in the frame of the surface: those of Surface::drawing() without the points that
/// were not found and the polygons that contain them, and with the opposite orientation for a concave surface
PolygonMesh tessellate(const Surface& surface, const DrawingExtent& extent);

// The parts of which surfaces compose their drawings

/// Numbers of divisions of a circle, of a half circle, of a patch
constexpr int around = 24, down = 12, across = 8;

/// Quadrilaterals of a grid of points; rows and columns may be closed to rings. The normal is row direction ×
/// column direction.
PolygonMesh grid(int rows, int columns, bool rows_join, bool columns_join,
                 const std::function<Vec3(int row, int column)>& point);

/// Square of half side `half` in the plane z = 0
PolygonMesh square(const Vec3& centre, double half, const std::function<Vec3(const Vec3&)>& image);
/// Image of the square in the plane z = 0 that covers the extent
PolygonMesh square(const DrawingExtent& extent, const std::function<Vec3(const Vec3&)>& image);

}  // namespace hilda::contact
