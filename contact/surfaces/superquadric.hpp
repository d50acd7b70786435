// SPDX-License-Identifier: GPL-3.0-or-later
/// A superquadric: ellipsoids, rounded boxes and rounded cylinders.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = (L / max(p, q)) (|x/a|^p + |y/b|^p + |z/c|^q - 1) with L = (abc)^(1/3).
///
/// p = q = 2 is an ellipsoid, p = q = 8 a box with round edges, p = 2 and q = 8 a cylinder with round edges.
/// For exponents above 2 the surface is flat (K has rank 0 or 1) on the coordinate planes. The common form
/// (|x/a|^p + |y/b|^p)^(q/p) is not used because it has no second derivative on the z axis for q = 2 < p.
class Superquadric final : public Surface {
public:
    /// Semi-axes along x, y and z [m]. InvalidInput unless all are positive and the exponents are in [2,
    /// 100]. Below 2 the curvature is unbounded.
    Superquadric(const Vec3& semi_axes, double p, double q);
    Superquadric(const Vec3& semi_axes, double p) : Superquadric(semi_axes, p, p) {}

    std::string name() const override { return "superquadric"; }
    double value(const Vec3& a) const override;
    Vec3 gradient(const Vec3& a) const override;
    Mat3 hessian(const Vec3& a) const override;
    bool convex() const override { return true; }
    std::optional<Vec3> support(const Vec3& u) const override;
    double size() const override { return L; }

    const Vec3 semi_axes;
    const double p, q;

private:
    double exponent(int k) const { return k < 2 ? p : q; }

    const double L, scale;
};

}  // namespace hilda::contact
