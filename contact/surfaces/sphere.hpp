// SPDX-License-Identifier: GPL-3.0-or-later
/// A sphere, convex (ball) or concave (spherical bowl).

#pragma once

#include "contact/surface.hpp"

#include <cmath>

namespace hilda::contact {

/// G = (|ᾱ|² - R²) / 2R. The shape operator is K = (I - n nᵀ) / R, with the opposite sign if concave.
class Sphere final : public Surface {
public:
    /// R [m]. With `concave` contact is on the inside. InvalidInput unless R is positive.
    explicit Sphere(double R, bool concave = false);

    std::string name() const override { return "sphere"; }
    double value(const Vec3& a) const override { return (a.squaredNorm() - R * R) / (2 * R); }
    Vec3 gradient(const Vec3& a) const override { return a / R; }
    Mat3 hessian(const Vec3&) const override { return Mat3::Identity() / R; }
    double sigma() const override { return concave ? -1 : 1; }
    bool convex() const override { return true; }
    std::optional<Vec3> support(const Vec3& u) const override { return Vec3(R * u); }
    /// NumericalFailure at the centre
    Vec3 project(const Vec3& a) const override;
    double size() const override { return R; }
    /// Arc length of the great circle, 2R asin(chord / 2R) [m]
    double arc(double chord) const override;
    double bounding_radius() const override { return concave ? INFINITY : R; }

    const double R;
    const bool concave;
};

}  // namespace hilda::contact
