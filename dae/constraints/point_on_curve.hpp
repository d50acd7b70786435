// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint PointOnCurve: a point of one body stays on a curve of the other.
#pragma once

#include "dae/constraint.hpp"
#include "io/expression.hpp"

#include <array>

namespace hilda::dae {

/// Point P of body i stays on a curve c(s) that is fixed in body j:
///
///     Phi_k = n_k . (p - c(s)),  k = 1, 2        p: position of P in the frame of body j [m]
///
/// s is the parameter of the point of the curve nearest to p: c'(s) . (p - c(s)) = 0. n_1 and n_2 are unit
/// normals of the curve at s. n_1 is the projection of an internal state e on the normal plane; e is n_1 of
/// the last node, so that the basis does not twist about the curve. The search of s starts from the value at
/// the last node, an internal state, so that the constraint stays on its branch of a curve that comes near to
/// itself.
///
/// γ is exact for a point on the curve.
class PointOnCurve final : public Constraint {
public:
    /// c: the coordinates of the curve as expressions in s, frame of body j [m]. s: parameter near the start.
    PointOnCurve(int i, const Vec3& s_bar_i, int j, std::array<io::Expression, 3> c, double s)
        : Constraint(i, j), s_bar_i(s_bar_i), c(std::move(c)), s(s)
    {}

    Size size() const override { return {.position_rows = 2}; }
    int internal_states() const override { return 4; }  ///< s, e

    void phi(const Arguments& x, double* out) const override;
    void variation(const Arguments& x, Derivatives& out) const override;
    void gamma(const Arguments& x, double* out) const override;
    std::string start_error(const Arguments& x) const override;
    /// Throws lie::NumericalFailure "curve_lost" if the curve has no nearest point or no tangent there.
    void update_internal_state(const Arguments& x, bool start, double* saved) const override;

private:
    struct Foot;
    Vec3 position(const Arguments& x) const;  ///< p
    Foot nearest(const Vec3& p, double guess) const;
    Foot foot(const Arguments& x) const;

    const Vec3 s_bar_i;
    const std::array<io::Expression, 3> c;
    const double s;
};

}  // namespace hilda::dae
