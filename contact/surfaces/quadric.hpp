// SPDX-License-Identifier: GPL-3.0-or-later
/// The surface of any equation of second degree: saddle, hyperboloid, elliptic cylinder, an ellipsoid askew.

#pragma once

#include "contact/surface.hpp"

namespace hilda::contact {

/// G = ᾱᵀQ ᾱ + 2 b·ᾱ + c, with
///
///     ∇G = 2 (Q ᾱ + b),   ∇²G = 2 Q
///
/// and the body where G < 0. All three coefficients are multiplied by one positive number, 1 / (2 |Q| L), which makes
/// |∇G| of order 1 [Q in 1/m, b in 1, c in m] and leaves G = 0 where it was.
///
/// L is told by what no choice of origin changes. With ᾱ_0 the point nearest to the origin at which Q ᾱ + b is
/// least, d = Q ᾱ_0 + b and G_0 = G(ᾱ_0): L = |d| / |Q| for a paraboloid, the smaller radius at its vertex, and
/// (|G_0| / |Q|)^(1/2) where d = 0, the shortest semi-axis of an ellipsoid; |Q| is the largest |eigenvalue|.
class Quadric final : public Surface {
public:
    /// A hollow, touched from inside, where concave. InvalidInput unless Q is symmetric and not zero, all are finite,
    /// and G = 0 is a surface: not empty, a point, a line, or one that meets itself, as a double cone does (for
    /// which see Cone).
    Quadric(const Mat3& Q, const Vec3& b, double c, bool concave = false);

    std::string name() const override { return "quadric"; }
    double value(const Vec3& a) const override { return a.dot(Q * a) + 2 * b.dot(a) + c; }
    Vec3 gradient(const Vec3& a) const override { return 2 * (Q * a + b); }
    Mat3 hessian(const Vec3&) const override { return 2 * Q; }
    double sigma() const override { return concave ? -1 : 1; }
    /// Of an ellipsoid
    bool convex() const override { return definite; }
    /// ᾱ_0 + Q⁻¹u (-G_0 / uᵀQ⁻¹u)^(1/2) of an ellipsoid
    std::optional<Vec3> support(const Vec3& u) const override;
    double size() const override { return L; }

    /// What the coefficients do not say of a surface, in words; empty where they do.
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
    Mat3 inverse;  // Q⁻¹ of an ellipsoid
};

}  // namespace hilda::contact
