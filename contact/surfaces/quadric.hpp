// SPDX-License-Identifier: GPL-3.0-or-later
/// A general quadric, such as a saddle, a hyperboloid, an elliptic cylinder or an ellipsoid in general
/// position.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = ᾱᵀQ ᾱ + 2 b·ᾱ + c, with
///
///     ∇G = 2 (Q ᾱ + b),   ∇²G = 2 Q
///
/// The body is where G < 0. The coefficients are multiplied by 1 / (2 |Q| L), so that |∇G| is of order 1; the
/// units are then [1/m] for Q, [1] for b and [m] for c. The surface G = 0 does not change.
///
/// The characteristic length L follows from quantities that do not depend on the origin of the frame. Let ᾱ_0
/// be the point of smallest |Q ᾱ + b| that is closest to the origin, d = Q ᾱ_0 + b, G_0 = G(ᾱ_0), and |Q| the
/// largest |eigenvalue|. If d ≠ 0 (paraboloid), L = |d| / |Q|, the smaller radius of curvature at the vertex.
/// Otherwise L = (|G_0| / |Q|)^(1/2), the shortest semi-axis of an ellipsoid.
class Quadric final : public Surface {
public:
    /// With `concave` contact is on the inside. InvalidInput unless all coefficients are finite, Q is
    /// symmetric and not zero, and G = 0 is a regular surface: not empty, a point or a line, and without
    /// self-intersection. For a single cone see Cone.
    Quadric(const Mat3& Q, const Vec3& b, double c, bool concave = false);

    std::string name() const override { return "quadric"; }
    double value(const Vec3& a) const override { return a.dot(Q * a) + 2 * b.dot(a) + c; }
    Vec3 gradient(const Vec3& a) const override { return 2 * (Q * a + b); }
    Mat3 hessian(const Vec3&) const override { return 2 * Q; }
    double sigma() const override { return concave ? -1 : 1; }
    /// True for an ellipsoid
    bool convex() const override { return definite; }
    /// ᾱ_0 + Q⁻¹u (-G_0 / uᵀQ⁻¹u)^(1/2) for an ellipsoid, otherwise nothing
    std::optional<Vec3> support(const Vec3& u) const override;
    double size() const override { return L; }

    /// Why the coefficients do not define a regular surface; empty if they do
    static std::string fault(const Mat3& Q, const Vec3& b, double c);

    const bool concave;

private:
    struct Invariants;
    Quadric(const Mat3& Q, const Vec3& b, double c, bool concave, const Invariants& known);

    double L;
    Mat3 Q;
    Vec3 b;
    double c;
    bool definite;
    Vec3 centre;   // ᾱ_0
    Mat3 inverse;  // Q⁻¹ of an ellipsoid, otherwise zero
};

}  // namespace hilda::contact
