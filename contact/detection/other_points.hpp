// SPDX-License-Identifier: GPL-3.0-or-later
/// Watches a pair of surfaces for contact points other than the one that a contact follows.

#pragma once

#include "contact/detection/common_normal.hpp"

namespace hilda::contact {

/// A search for overlap at other points of a pair, repeated whenever the bodies have moved.
///
/// Two convex bodies have one contact point. In a bowl that is narrower than the ball, or on a torus, there
/// may be several, and a contact has the force of one. The search runs Newton's method on the common normal
/// from nine starting points. It is repeated when a body has moved by 2 % of the smaller size relative to the
/// other since the last search, so that an overlap is found before it is much larger.
class OtherPoints {
public:
    OtherPoints(const Shape& i, const Shape& j);

    /// Whether the pair may have several contact points: a torus, or a concave surface other than a sphere or
    /// cylinder around a sphere. Height maps and triangle meshes are not searched.
    static bool possible(const Shape& i, const Shape& j);
    /// The search for a pair that may have several contact points, otherwise nullptr
    static std::unique_ptr<const OtherPoints> of(const Shape& i, const Shape& j);

    /// The pose of surface i in the frame of surface j at the last search; A is zero before the first one
    struct Pose {
        Vec3 r;
        Mat3 A;
    };
    /// Throws lie::NumericalFailure "contact_not_unique" if the surfaces overlap at another point than
    /// `followed`, or if they overlap at `followed` where the sum of their curvatures is negative beyond the
    /// effect of a small overlap: one surface does not fit into the other there. `contact` is the name of the
    /// contact.
    void check(const std::string& contact, const Motion& bi, const Motion& bj, const ContactPoint& followed,
               Pose& last) const;

private:
    const Shape i, j;
    const CommonNormal common_normal;
    const double size;  ///< smaller size of the two surfaces [m]
    const bool spheres_i, spheres_j;
};

}  // namespace hilda::contact
