// SPDX-License-Identifier: GPL-3.0-or-later
/// A plane, such as a floor, a wall or an incline.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// Base class of flat surfaces, G = z
class Flat : public Surface {
public:
    double value(const Vec3& a) const final { return a.z(); }
    Vec3 gradient(const Vec3&) const final { return Vec3::UnitZ(); }
    Mat3 hessian(const Vec3&) const final { return Mat3::Zero(); }
    Vec3 project(const Vec3& a) const final { return {a.x(), a.y(), 0}; }
    double size() const final { return 0; }
};

/// The plane z = 0 of its frame. The normal is +z and the body lies below the plane.
class Plane final : public Flat {
public:
    std::string name() const override { return "plane"; }
    PolygonMesh drawing(const DrawingExtent& extent) const override;
};

}  // namespace hilda::contact
