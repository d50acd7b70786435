// SPDX-License-Identifier: GPL-3.0-or-later
/// Any pair of smooth surfaces: Newton's method on the common normal.

#pragma once

#include "contact/detection/detectors.hpp"

namespace hilda::contact {

/// Points x_i and x_j on the two surfaces with the common normal n = n_j = -n_i between them:
///
///     x_i - x_j = g n,   Tᵀ(n_i + n_j) = 0,   G_i = 0,   G_j = 0
///
/// Seven equations for ᾱ_i, ᾱ_j and the gap g, with T a tangent basis of n_j, frozen while they are linearised.
/// Three unknowns are eliminated by hand: the gap, of which Tᵀ(x_i - x_j) = 0 is free, and the steps -G/|∇G| along
/// the normals. Four are left, the steps in the tangent planes.
///
/// The equations hold wherever the distance is stationary, on the far sides of two bodies too. A touch is where
/// the relative curvature K_i + K_j + g K_i K_j is positive: for two balls, where R_i + R_j + g > 0.
///
/// Two convex bodies have one touch, and it is followed. In a bowl, or with a ring, there may be several: a touch
/// is followed while there is overlap; between bodies that are apart the one with the smallest gap is looked for.
class CommonNormal final : public Detector {
public:
    CommonNormal(const Shape& i, const Shape& j);

    ContactPoint detect(const Motion& bi, const Motion& bj, const Points* from) const override;

    /// Shapes i and j, in global axes but from the origin of shape j, so that what is near is computed near; and
    /// the points reached on them
    struct Pair {
        Placed i, j;
        Vec3 a_i = Vec3::Zero(), a_j = Vec3::Zero();
    };
    Pair placed(const Motion& bi, const Motion& bj) const;
    /// Points to begin from: support points along the normal, which it turns until they face each other, or,
    /// where a surface knows no support, projections from one to the other, from the middle of one or, if it is not
    /// zero, from a corner of the space around it. False where that leads nowhere.
    bool begin(Pair& p, int projections, const Vec3& corner) const;
    /// One step of Newton's method, cut where it would turn a normal by more than half a radian. Returns the
    /// larger displacement of the two points [m], not finite where the equations are singular.
    double improve(Pair& p) const;

    /// Says where a body is wider than the bowl that it should lie in, along an axis of either. Empty where it is not, and
    /// where neither is a bowl.
    std::string misfit(const Motion& bi, const Motion& bj) const;

private:
    struct Outcome;
    Outcome solve(Pair& p, const Vec3& origin) const;
    void turn_normal(Pair& p) const;
    void alternate(Pair& p, int projections, const Vec3& corner) const;
    bool supported() const;
    std::string why_no_beginning(const Motion& bi, const Motion& bj) const;
    bool crossed(const Pair& p, double gap) const;
    std::optional<ContactPoint> apart(const Motion& bi, const Motion& bj, const Vec3& origin) const;

    const Shape i, j;
    const double small, large;      // sizes of the two surfaces; both that of the other where one is a plane
    const double reach_i, reach_j;  // of balls that hold the bodies
    const bool single;              // two convex bodies, with a single touch
};

}  // namespace hilda::contact
