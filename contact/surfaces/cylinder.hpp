// SPDX-License-Identifier: GPL-3.0-or-later
/// An infinite circular cylinder, convex (shaft) or concave (pipe).

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = (x² + y² - R²) / 2R. The axis is z of its frame; the curvature is 1/R around the axis and 0 along it.
class Cylinder final : public Surface {
public:
    /// R [m]. With `concave` contact is on the inside (pipe). InvalidInput unless R is positive.
    explicit Cylinder(double R, bool concave = false);

    std::string name() const override { return "cylinder"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override { return {a.x() / R, a.y() / R, 0}; }
    Mat3 hessian(const Vec3&) const override { return Vec3(1 / R, 1 / R, 0).asDiagonal(); }
    double sigma() const override { return concave ? -1 : 1; }
    /// NumericalFailure on the axis
    Vec3 project(const Vec3& a) const override;
    double size() const override { return R; }
    /// The drawn length is at least the diameter.
    PolygonMesh drawing(const DrawingExtent& extent) const override;

    const double R;
    const bool concave;
};

}  // namespace hilda::contact
