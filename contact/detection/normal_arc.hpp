// SPDX-License-Identifier: GPL-3.0-or-later
/// The normals of a line or edge at which a smooth convex body is farthest from it.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// The unit vectors n(φ) = n cos φ + m sin φ, 0 ≤ φ ≤ end ≤ π, normal to an edge through the point a. With
/// the support point x(φ) of a smooth convex body along -n(φ), the separation of the two along n(φ) and its
/// derivative are
///
///     s = n(φ) · (x - a),   ds/dφ = n'(φ) · (x - a)
class NormalArc {
public:
    /// n, m: orthogonal unit vectors; `length`: below it a length is zero [m]
    NormalArc(const Surface& body, const Vec3& a, const Vec3& n, const Vec3& m, double end, double length)
        : body(body), a(a), n(n), m(m), end(end), length(length)
    {}

    /// Searches the maximum of s within the arc, not at its ends. Returns false if there is none; if it is
    /// less than `known`, it may return false. Bodies that overlap by more than a radius of curvature may
    /// have several maxima, of which it finds one.
    bool find(double known);

    Vec3 direction = Vec3::Zero(), x = Vec3::Zero();  ///< n(φ) and x of the maximum
    double s() const { return direction.dot(x - a); }

private:
    Vec3 normal(double phi) const { return std::cos(phi) * n + std::sin(phi) * m; }
    double slope(double phi);
    double largest_on_chord(double first, double last, double known) const;
    bool climb(double phi);

    const Surface& body;
    const Vec3 a, n, m;
    const double end, length;
};

}  // namespace hilda::contact
