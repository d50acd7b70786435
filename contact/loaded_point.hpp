// SPDX-License-Identifier: GPL-3.0-or-later
/// The forces at the contact points of a pair of bodies that touch at several places.

#pragma once

#include "contact/detection/manifold.hpp"

namespace hilda::contact {

/// A contact point of a pair and its force, for output
struct LoadedPoint {
    ContactPoint at;
    std::uint32_t feature = 0;  ///< see ManifoldPoint
    double N = 0;               ///< normal force on body i [N]
    Vec3 F = Vec3::Zero();      ///< friction force on body i [N], global frame
    Vec3 T = Vec3::Zero();      ///< friction torque on body i about the point [N m], global frame
    bool slips = false;
};

}  // namespace hilda::contact
