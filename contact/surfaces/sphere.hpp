// SPDX-License-Identifier: GPL-3.0-or-later
/// A sphere: ball or bowl.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = (|ᾱ|² - R²) / 2R. K = (I - n nᵀ) / R everywhere, with the other sign in a bowl.
class Sphere final : public Surface {
public:
    /// R [m]; a bowl where concave. InvalidInput unless R is positive.
    explicit Sphere(double R, bool concave = false);

    std::string name() const override { return "sphere"; }
    double value(const Vec3& a) const override { return (a.squaredNorm() - R * R) / (2 * R); }
    Vec3 gradient(const Vec3& a) const override { return a / R; }
    Mat3 hessian(const Vec3&) const override { return Mat3::Identity() / R; }
    double sigma() const override { return concave ? -1 : 1; }
    bool convex() const override { return true; }
    std::optional<Vec3> support(const Vec3& u) const override { return Vec3(R * u); }
    /// NumericalFailure for the centre
    Vec3 project(const Vec3& a) const override;
    double size() const override { return R; }
    /// 2R asin(chord / 2R): of the great circle
    double arc(double chord) const override;

    const double R;
    const bool concave;
};

}  // namespace hilda::contact
