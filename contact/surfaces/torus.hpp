// SPDX-License-Identifier: GPL-3.0-or-later
/// A torus, convex (ring) or concave (groove).

#pragma once

#include "contact/surface.hpp"

#include <cmath>

namespace hilda::contact {

/// G = ((ρ - R)² + z² - r²) / 2r with ρ² = x² + y²: a tube of radius r around the circle of radius R about z.
/// G is not differentiable on the axis.
class Torus final : public Surface {
public:
    /// Radii of ring and tube [m]. With `concave` contact is inside the tube. InvalidInput unless 0 < r < R.
    Torus(double R, double r, bool concave = false);

    std::string name() const override { return "torus"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override;
    Mat3 hessian(const Vec3& a) const override;
    double sigma() const override { return concave ? -1 : 1; }
    /// The support point on the outer half. NumericalFailure if u is parallel to the axis
    std::optional<Vec3> support(const Vec3& u) const override;
    /// NumericalFailure on the axis and on the centre line of the tube
    Vec3 project(const Vec3& a) const override;
    double size() const override { return r; }
    double bounding_radius() const override { return concave ? INFINITY : R + r; }
    bool is_unbounded() const override { return false; }
    PolygonMesh drawing(const DrawingExtent& extent) const override;

    const double R, r;
    const bool concave;
};

}  // namespace hilda::contact
