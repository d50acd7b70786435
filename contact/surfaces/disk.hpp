// SPDX-License-Identifier: GPL-3.0-or-later
/// A thin disk that is in contact with its rim: coin, hoop, wheel.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// The rim is the circle of radius R about z in the plane z = 0 of its frame. A circle is not a surface G =
/// 0; G is that of the cylinder through the rim, G = (x² + y² - R²) / 2R, which has the curvature of the
/// upright disk.
///
/// The contact detector uses the normal curvature of the rim (Meusnier's theorem) in all tangent directions,
/// with θ the angle between the plane of the disk and the contact normal:
///
///     K = (1/R) cos θ (I - n nᵀ)
///
/// Across the rim the disk has an edge of zero radius. The curvature of the rim is used in this direction
/// too, so that κ, and with it rolling and spinning friction, does not depend on the direction of motion.
class Disk final : public Surface {
public:
    /// R [m]. InvalidInput unless it is positive.
    explicit Disk(double R);

    std::string name() const override { return "disk"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override { return {a.x() / R, a.y() / R, 0}; }
    Mat3 hessian(const Vec3&) const override { return Vec3(1 / R, 1 / R, 0).asDiagonal(); }
    /// The closest point of the rim. NumericalFailure on the axis
    Vec3 project(const Vec3& a) const override;
    double size() const override { return R; }
    /// Arc length along the rim, 2R asin(chord / 2R) [m]
    double arc(double chord) const override;
    bool is_smooth() const override { return false; }
    double bounding_radius() const override { return R; }
    bool is_unbounded() const override { return false; }
    PolygonMesh drawing(const DrawingExtent& extent) const override;

    const double R;
};

}  // namespace hilda::contact
