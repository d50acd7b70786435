// SPDX-License-Identifier: GPL-3.0-or-later
/// A thin disk that touches with its rim: coin, hoop, wheel.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// The rim is the circle of radius R about z, in the plane z = 0 of its frame. A circle has no G: as a surface
/// the disk is the cylinder through it, G = (x² + y² - R²) / 2R, which has the curvature of the upright disk.
///
/// Its detector gives the curvature of the rim as seen along the contact normal, with θ the angle of the plane of the
/// disk to the normal (Meusnier), in all directions alike:
///
///     K = (1/R) cos θ (I - n nᵀ)
///
/// Across the rim a disk has an edge, which rolls over no distance. Giving it the curvature of the rim there too keeps
/// κ, and with it rolling and spinning friction, the same whether the disk moves or stands.
class Disk final : public Surface {
public:
    /// R [m]. InvalidInput unless it is positive.
    explicit Disk(double R);

    std::string name() const override { return "disk"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override { return {a.x() / R, a.y() / R, 0}; }
    Mat3 hessian(const Vec3&) const override { return Vec3(1 / R, 1 / R, 0).asDiagonal(); }
    /// The nearest point of the rim. NumericalFailure on the axis
    Vec3 project(const Vec3& a) const override;
    double size() const override { return R; }
    /// 2R asin(chord / 2R): along the rim
    double arc(double chord) const override;

    const double R;
};

}  // namespace hilda::contact
