// SPDX-License-Identifier: GPL-3.0-or-later
/// The drawing of a body without a contact surface.

#pragma once

#include "contact/tessellation.hpp"
#include "dae/body.hpp"

namespace hilda::run {

/// Polygons of a body, in the body frame: its shape if it has one, otherwise its equivalent_solid(). The
/// polygons are counterclockwise seen from outside.
contact::PolygonMesh body_drawing(const dae::Body& body);

/// The homogeneous box or sphere with the mass and the inertia of the body, in the body frame:
///
///     box      a_1² = 6 (J_2 + J_3 - J_1)/m along the principal axis of J_1; a_2 and a_3 by permutation
///     sphere   R² = 5 J/(2 m) if the three principal moments are equal
///
/// A side of the box is drawn with at least a fiftieth of the longest side, so that a slender bar is visible.
contact::PolygonMesh equivalent_solid(const dae::Body& body);

/// Whether the principal moments are equal, so that the equivalent solid is a sphere
bool has_equal_moments(const dae::Body& body);

}  // namespace hilda::run
