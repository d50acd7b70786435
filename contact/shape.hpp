// SPDX-License-Identifier: GPL-3.0-or-later
/// A surface fixed to a body.

#pragma once

#include "contact/surface.hpp"

#include <algorithm>
#include <limits>
#include <memory>

namespace hilda::contact {

/// A surface and its pose in the body frame: s̄ = position + orientation ᾱ, where ᾱ are the coordinates of a
/// point in the frame of the surface and s̄ those in the body frame [m].
struct Shape {
    std::shared_ptr<const Surface> surface;
    Vec3 position = Vec3::Zero();         ///< origin of the surface frame, in the body frame [m]
    Mat3 orientation = Mat3::Identity();  ///< rotation matrix from the surface frame to the body frame

    Vec3 to_surface(const Vec3& s_bar) const { return orientation.transpose() * (s_bar - position); }
    Vec3 to_body(const Vec3& a) const { return position + orientation * a; }
};

/// The smaller size of two surfaces [m]. A surface without a size, such as a plane, does not count; infinite
/// if neither has one.
inline double smaller_size(const Shape& i, const Shape& j)
{
    double smaller = std::numeric_limits<double>::infinity();
    for (const Shape* s : {&i, &j})
        if (s->surface->size() > 0) smaller = std::min(smaller, s->surface->size());
    return smaller;
}

}  // namespace hilda::contact
