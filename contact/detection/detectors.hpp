// SPDX-License-Identifier: GPL-3.0-or-later
/// The detectors there are, for make_detector to choose from.

#pragma once

#include "contact/detection/detector.hpp"

namespace hilda::contact {

/// A shape of a moving body in the global frame
struct Placed {
    Vec3 origin;
    Mat3 axes;

    Placed(const Shape& s, const Motion& b) : origin(b.r + b.A * s.position), axes(b.A * s.orientation) {}
};

/// What a detector of j and i says of i and j: the same numbers, with the sign of n changed.
ContactPoint detect_exchanged(const Detector& ji, const Motion& bi, const Motion& bj, const Points* from);

// Each makes a detector for the surfaces in its name, i before j, and none for others.

std::unique_ptr<Detector> sphere_plane(const Shape& i, const Shape& j);
/// Ball and ball, ball in bowl, bowl on ball. InvalidInput unless the ball is the smaller.
std::unique_ptr<Detector> sphere_sphere(const Shape& i, const Shape& j);
std::unique_ptr<Detector> foot_plane(const Shape& i, const Shape& j);
std::unique_ptr<Detector> disk_plane(const Shape& i, const Shape& j);
/// NumericalFailure where they are parallel
std::unique_ptr<Detector> cylinder_cylinder(const Shape& i, const Shape& j);
/// Any surface that knows its support in closed form
std::unique_ptr<Detector> support_plane(const Shape& i, const Shape& j);
/// Any two surfaces
std::unique_ptr<Detector> common_normal(const Shape& i, const Shape& j);

}  // namespace hilda::contact
