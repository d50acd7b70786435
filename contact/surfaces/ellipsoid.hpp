// SPDX-License-Identifier: GPL-3.0-or-later
/// An ellipsoid, convex or concave.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = (L/2) (x²/a² + y²/b² + z²/c² - 1) with L = (abc)^(1/3), so that |∇G| is of order 1.
///
/// With the distance p = (x²/a⁴ + y²/b⁴ + z²/c⁴)^(-1/2) from the centre to the tangent plane, the Gaussian
/// curvature is p⁴/(abc)² and the mean curvature p³ (a² + b² + c² - |ᾱ|²) / 2(abc)².
class Ellipsoid final : public Surface {
public:
    /// Semi-axes along x, y and z [m]. With `concave` contact is on the inside. InvalidInput unless all are
    /// positive.
    explicit Ellipsoid(const Vec3& semi_axes, bool concave = false);

    std::string name() const override { return "ellipsoid"; }
    double value(const Vec3& a) const override { return 0.5 * (a.dot(curvature.cwiseProduct(a)) - L); }
    Vec3 gradient(const Vec3& a) const override { return curvature.cwiseProduct(a); }
    Mat3 hessian(const Vec3&) const override { return curvature.asDiagonal(); }
    double sigma() const override { return concave ? -1 : 1; }
    bool convex() const override { return true; }
    /// D² u / |D u| with D = diag(a, b, c)
    std::optional<Vec3> support(const Vec3& u) const override;
    /// Defined for every point, also inside; see ellipsoid.cpp
    Vec3 project(const Vec3& a) const override;
    double size() const override { return L; }

    const Vec3 semi_axes;
    const bool concave;

private:
    const double L;
    const Vec3 curvature;  // L/a², L/b², L/c²
};

}  // namespace hilda::contact
