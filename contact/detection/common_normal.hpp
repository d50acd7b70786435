// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact detection for any pair of smooth surfaces: Newton's method on the common normal.

#pragma once

#include "contact/detection/detectors.hpp"

#include <optional>

namespace hilda::contact {

/// Finds points x_i and x_j on the two surfaces with the common normal n = n_j = -n_i:
///
///     x_i - x_j = g n,   Tᵀ(n_i + n_j) = 0,   G_i = 0,   G_j = 0
///
/// These are seven equations for ᾱ_i, ᾱ_j and the gap g. T is a tangent basis of n_j and is held constant in
/// the linearisation. Three unknowns are eliminated analytically: the gap, because Tᵀ(x_i - x_j) = 0 does not
/// contain it, and the steps -G/|∇G| along the normals. The remaining four unknowns are the steps in the
/// tangent planes.
///
/// The equations hold at every stationary point of the distance, also on the far sides of two bodies. A
/// solution is accepted as contact point only if the relative curvature K_i + K_j + g K_i K_j is positive
/// definite in the tangent plane. For two spheres this means R_i + R_j + g > 0.
///
/// Two convex bodies have a single contact point, and the search continues from the previous one. With a
/// concave surface or a torus there may be several: the previous contact point is followed while the bodies
/// overlap there; otherwise several starting points are tried and the solution with the smallest gap is
/// returned.
class CommonNormal final : public Detector {
public:
    CommonNormal(const Shape& i, const Shape& j);

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const override;

    /// Poses of shapes i and j, and the current points ᾱ_i, ᾱ_j of the iteration. Positions are relative to
    /// the origin of shape j, in global axes, so that the accuracy does not depend on the distance to the
    /// global origin.
    struct Pair {
        PlacedShape i, j;
        Vec3 a_i = Vec3::Zero(), a_j = Vec3::Zero();
    };
    Pair placed(const Motion& bi, const Motion& bj) const;
    /// Sets the starting points of Newton's method. With `projections` = 0 they are the support points of the
    /// normal of largest separation (both surfaces need support functions). Otherwise they result from that
    /// many alternating projections, which start from the origin of one surface or, if `corner` is not zero,
    /// from a far point in that direction. Returns false if no points are found.
    bool set_start_points(Pair& p, int projections, const Vec3& corner) const;
    /// One step of Newton's method. It is shortened if it would rotate a normal by more than 0.5 rad or move
    /// a point by more than twice the larger size. Returns the larger displacement of the two points [m]; it
    /// is not finite if the equations are singular.
    double newton_step(Pair& p) const;

    /// Whether the relative curvature at converged points p is positive definite
    bool is_nearest(const Pair& p) const;

    /// The point with the largest overlap, at least `least` [m], of those that are not `known`; empty if
    /// there is none. Searches from nine starting points.
    std::optional<ContactPoint> find_overlap_besides(const ContactPoint& known, const Motion& bi,
                                                     const Motion& bj, double least) const;

    /// If one surface is convex and the other concave, compares their widths along the axes of both frames.
    /// Returns a message if the convex body is wider than the concave surface, otherwise an empty text.
    std::string width_conflict(const Motion& bi, const Motion& bj) const;

private:
    struct SearchResult;
    SearchResult solve(Pair& p, const Vec3& origin) const;
    void search_normal(Pair& p) const;
    void project_alternately(Pair& p, int projections, const Vec3& corner) const;
    bool have_support_functions() const;
    std::string start_failure(const Motion& bi, const Motion& bj) const;
    bool is_false_overlap(const Pair& p, double gap) const;
    std::optional<ContactPoint> find_separated_points(const Motion& bi, const Motion& bj,
                                                      const Vec3& origin) const;

    const Shape i, j;
    // sizes of the two surfaces [m]; a plane takes the size of the other
    const double smaller_size, larger_size;
    // of the bodies about the origins of the surfaces [m]; may be infinite
    const double bounding_radius_i, bounding_radius_j;
    const bool both_convex;  // then the contact point is unique
};

}  // namespace hilda::contact
