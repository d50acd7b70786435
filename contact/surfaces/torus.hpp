// SPDX-License-Identifier: GPL-3.0-or-later
/// A torus: ring, tyre, or the groove in which balls run.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = ((ρ - R)² + z² - r²) / 2r with ρ² = x² + y²: a tube of radius r around the circle of radius R about z.
/// G has no derivative on the axis.
class Torus final : public Surface {
public:
    /// Radii of ring and tube [m]; touched from within the tube where concave. InvalidInput unless 0 < r < R.
    Torus(double R, double r, bool concave = false);

    std::string name() const override { return "torus"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override;
    Mat3 hessian(const Vec3& a) const override;
    double sigma() const override { return concave ? -1 : 1; }
    /// On the outer half. NumericalFailure along the axis
    std::optional<Vec3> support(const Vec3& u) const override;
    /// NumericalFailure on the axis and on the centre line of the tube
    Vec3 project(const Vec3& a) const override;
    double size() const override { return r; }

    const double R, r;
    const bool concave;
};

}  // namespace hilda::contact
