// SPDX-License-Identifier: GPL-3.0-or-later
/// Convex hulls with plane faces of any number of corners.

#pragma once

#include "lie/so3.hpp"

#include <vector>

namespace hilda::contact {

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

}  // namespace hilda::contact
