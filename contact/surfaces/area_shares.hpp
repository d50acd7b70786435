// SPDX-License-Identifier: GPL-3.0-or-later
/// The parts of the area of a polygon that its corners stand for.

#pragma once

#include "lie/so3.hpp"

#include <span>
#include <vector>

namespace hilda::contact {

/// Sets the shares s_k of the corners x_k of a plane convex polygon with the area A and the centroid c:
///
///     s_k = (A_{k-1} + A_k)/(2 A),   A_k the area of the triangle c, x_k, x_{k+1}.
///
/// Their sum is 1, Σ s_k x_k = c, and corners at the same place together have the share of one. The corners
/// of a polygon without area, such as a segment, have equal shares.
void area_shares(std::span<const lie::Vec3> corner, std::vector<double>& share);

}  // namespace hilda::contact
