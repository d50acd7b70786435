// SPDX-License-Identifier: GPL-3.0-or-later
/// The flat face of a body that slides without tipping.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = z, as a plane, but it touches at the origin of its frame and nowhere else: all of its load acts there.
/// A brick on an incline is a foot on a plane. Put the origin where the resultant of the true pressure acts;
/// what that pressure does to hold the brick flat is not modelled.
class Foot final : public Surface {
public:
    std::string name() const override { return "foot"; }
    double value(const Vec3& a) const override { return a.z(); }
    Vec3 gradient(const Vec3&) const override { return Vec3::UnitZ(); }
    Mat3 hessian(const Vec3&) const override { return Mat3::Zero(); }
    Vec3 project(const Vec3& a) const override { return {a.x(), a.y(), 0}; }
    double size() const override { return 0; }
};

}  // namespace hilda::contact
