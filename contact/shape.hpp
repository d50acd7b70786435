// SPDX-License-Identifier: GPL-3.0-or-later
/// A surface on a body.

#pragma once

#include "contact/surface.hpp"

#include <memory>

namespace hilda::contact {

/// A surface with its pose in the body: ᾱ of the surface is the point position + orientation ᾱ of the body frame.
struct Shape {
    std::shared_ptr<const Surface> surface;
    Vec3 position = Vec3::Zero();         ///< of its origin, body frame [m]
    Mat3 orientation = Mat3::Identity();  ///< from its frame to the body frame

    Vec3 to_surface(const Vec3& s_bar) const { return orientation.transpose() * (s_bar - position); }
    Vec3 to_body(const Vec3& a) const { return position + orientation * a; }
};

}  // namespace hilda::contact
