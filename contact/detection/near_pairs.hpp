// SPDX-License-Identifier: GPL-3.0-or-later
/// The pairs of a group of bodies that are close to each other.

#pragma once

#include "contact/contact_pairs.hpp"
#include "contact/shape.hpp"
#include "lie/state.hpp"

#include <span>
#include <vector>

namespace hilda::contact {

/// Radius of a sphere about the centre of mass that contains a surface of a body [m]; infinite if there is
/// none
double reach_about_centre(const Shape& shape);

/// The numbers of the pairs, ascending, whose bounding spheres touch if body b moves by at most motion[b]
/// [m]. A plane of the ground has no bounding sphere; its pairs are near if the bounding sphere of the other
/// body is close to the plane. Does not allocate after its memory has grown. Returns the number of distances
/// that were computed.
long find_near_pairs(const ContactPairs& of, const Shape& shape_i, const Shape& shape_j,
                     const std::vector<lie::Motion>& body, std::span<const double> motion,
                     std::vector<int>& numbers);

}  // namespace hilda::contact
