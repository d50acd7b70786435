// SPDX-License-Identifier: GPL-3.0-or-later
/// A paraboloid: the dish in which balls roll, or a blunt nose.

#pragma once

#include "contact/surface.hpp"

#include <algorithm>

namespace hilda::contact {

/// G = (x²/R_x + y²/R_y) / 2 - z: opens along z of its frame, with its vertex at the origin and the curvatures 1/R_x
/// and 1/R_y there. |∇G| is 1 at the vertex.
class Paraboloid final : public Surface {
public:
    /// Radii of curvature at the vertex [m]; a dish, touched from inside, where concave. InvalidInput unless both
    /// are positive: for a saddle see Quadric.
    Paraboloid(double R_x, double R_y, bool concave = false);

    std::string name() const override { return "paraboloid"; }
    double value(const Vec3& a) const override { return 0.5 * a.dot(curvature.cwiseProduct(a)) - a.z(); }
    Vec3 gradient(const Vec3& a) const override { return curvature.cwiseProduct(a) - Vec3::UnitZ(); }
    Mat3 hessian(const Vec3&) const override { return curvature.asDiagonal(); }
    double sigma() const override { return concave ? -1 : 1; }
    /// Everywhere, inside too: see paraboloid.cpp
    Vec3 project(const Vec3& a) const override;
    double size() const override { return std::min(R_x, R_y); }

    const double R_x, R_y;
    const bool concave;

private:
    const Vec3 curvature;  // 1/R_x, 1/R_y, 0
};

}  // namespace hilda::contact
