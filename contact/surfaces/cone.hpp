// SPDX-License-Identifier: GPL-3.0-or-later
/// An infinite circular cone, convex (tip) or concave (funnel).

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = ρ cos β - z sin β with ρ² = x² + y². The cone opens along +z of its frame, its apex is the origin, and
/// β is the half angle between axis and side. The principal curvatures are 0 along the sides and cos β / ρ
/// across them; |∇G| = 1.
///
/// The quadratic form x² + y² - z² tan² β is not used because it has a second nappe, whose inside would also
/// be part of the body. The normal is not defined on the axis: lie::NumericalFailure with the point.
class Cone final : public Surface {
public:
    /// β [rad]. With `concave` contact is on the inside (funnel). InvalidInput unless 0 < β < π/2.
    explicit Cone(double half_angle, bool concave = false);

    std::string name() const override { return "cone"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override;
    Mat3 hessian(const Vec3& a) const override;
    double sigma() const override { return concave ? -1 : 1; }
    /// NumericalFailure on the axis, and if the apex is the closest point
    Vec3 project(const Vec3& a) const override;
    double size() const override { return 0; }  ///< a cone has no characteristic length

    const double half_angle;
    const bool concave;

private:
    const double sine, cosine;
};

}  // namespace hilda::contact
