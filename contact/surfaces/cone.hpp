// SPDX-License-Identifier: GPL-3.0-or-later
/// A cone without end: tip or funnel.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = ρ cos β - z sin β with ρ² = x² + y²: opens along z of its frame, with its apex at the origin and the angle β
/// between axis and side. It is straight along its sides and has the curvature cos β / ρ across them; |∇G| = 1.
///
/// The usual x² + y² - z² tan² β has a second half, above the apex, whose inside would be taken for the body.
/// At the apex, and on the axis behind it, there is no normal: lie::NumericalFailure with the point.
class Cone final : public Surface {
public:
    /// β [rad]; a funnel, touched from inside, where concave. InvalidInput unless 0 < β < π/2.
    explicit Cone(double half_angle, bool concave = false);

    std::string name() const override { return "cone"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override;
    Mat3 hessian(const Vec3& a) const override;
    double sigma() const override { return concave ? -1 : 1; }
    /// NumericalFailure on the axis, and where the apex is the nearest point
    Vec3 project(const Vec3& a) const override;
    double size() const override { return 0; }  ///< it looks the same from near and from far

    const double half_angle;
    const bool concave;

private:
    const double sine, cosine;
};

}  // namespace hilda::contact
