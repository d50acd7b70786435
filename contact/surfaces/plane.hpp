// SPDX-License-Identifier: GPL-3.0-or-later
/// A plane: floor, wall, incline.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = z: the plane through the origin of its frame, with the body below it and the normal along z.
class Plane final : public Surface {
public:
    std::string name() const override { return "plane"; }
    double value(const Vec3& a) const override { return a.z(); }
    Vec3 gradient(const Vec3&) const override { return Vec3::UnitZ(); }
    Mat3 hessian(const Vec3&) const override { return Mat3::Zero(); }
    Vec3 project(const Vec3& a) const override { return {a.x(), a.y(), 0}; }
    double size() const override { return 0; }
};

}  // namespace hilda::contact
