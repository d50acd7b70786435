// SPDX-License-Identifier: GPL-3.0-or-later
/// Convex hulls with plane faces of any number of corners.

#pragma once

#include "lie/so3.hpp"

#include <optional>
#include <vector>

namespace hilda::dae {

/// The faces of the convex hull of points in space, each as the numbers of its corners, counterclockwise seen
/// from outside. Points of a face that are not corners of it, and points inside, belong to no face. Points in
/// a plane have two faces of opposite orientation; points on a line, and a single point, have none.
///
/// Gift wrapping: from a face across each of its edges to the plane through the edge with all points on one
/// side, O(n f) for n points and f faces. Points closer to a plane than `tolerance` [m] belong to it.
///
/// Throws lie::InvalidInput if the faces do not close, as for points that are closer to each other than the
/// tolerance.
std::vector<std::vector<int>> convex_hull(const std::vector<lie::Vec3>& points, double tolerance);

/// Tolerances of convex_hull() relative to the extent of the points: for points of a text, and for those of a
/// mesh file, whose numbers may have single precision
inline constexpr double hull_tolerance = 1e-9, hull_tolerance_of_files = 1e-6;
/// Largest distance of a point from the first one [m]
double extent(const std::vector<lie::Vec3>& points);

/// Normal of a plane polygon, given by the numbers of its corners, times twice its area (Newell)
lie::Vec3 area_vector(const std::vector<int>& corners, const std::vector<lie::Vec3>& points);

/// A point inside of the hull and its depth below the nearest face [m]
struct InsidePoint {
    std::size_t number;
    double depth;
};
/// The first point that is deeper than `depth` below each of the faces of a hull, if there is one
std::optional<InsidePoint> inside_point(const std::vector<lie::Vec3>& points,
                                        const std::vector<std::vector<int>>& faces, double depth);

}  // namespace hilda::dae
