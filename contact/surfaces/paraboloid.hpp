// SPDX-License-Identifier: GPL-3.0-or-later
/// An elliptic paraboloid, convex or concave (dish).

#pragma once

#include "contact/surface.hpp"

#include <algorithm>

namespace hilda::contact {

/// G = (x²/R_x + y²/R_y) / 2 - z. It opens along +z of its frame. The vertex is the origin; the curvatures
/// there are 1/R_x and 1/R_y, and |∇G| = 1.
class Paraboloid final : public Surface {
public:
    /// Radii of curvature at the vertex [m]. With `concave` contact is on the inside (dish). InvalidInput
    /// unless both are positive; for a saddle see Quadric.
    Paraboloid(double R_x, double R_y, bool concave = false);

    std::string name() const override { return "paraboloid"; }
    double value(const Vec3& a) const override { return 0.5 * a.dot(curvature.cwiseProduct(a)) - a.z(); }
    Vec3 gradient(const Vec3& a) const override { return curvature.cwiseProduct(a) - Vec3::UnitZ(); }
    Mat3 hessian(const Vec3&) const override { return curvature.asDiagonal(); }
    double sigma() const override { return concave ? -1 : 1; }
    /// Defined for every point, also inside; see paraboloid.cpp
    Vec3 project(const Vec3& a) const override;
    double size() const override { return std::min(R_x, R_y); }

    const double R_x, R_y;
    const bool concave;

private:
    const Vec3 curvature;  // 1/R_x, 1/R_y, 0
};

}  // namespace hilda::contact
