// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint RotationToTranslation: displacement proportional to a relative rotation.
#pragma once

#include "dae/block.hpp"
#include "dae/block_terms.hpp"
#include "dae/constraints/angle.hpp"

namespace hilda::dae {

/// The displacement of a point of body j along a direction of body i is proportional to the rotation of body
/// j relative to body i:
///
///     Phi = e . d_ij - rho theta - C                                         [m]
///
/// e = A_i e_bar is a unit vector fixed in body i, and d_ij the vector from point P of body i to point Q of
/// body j. theta is the angle of the vector a of body j in the frame (u, w) of body i. It is counted over any
/// number of revolutions, as an internal state; a step may change it by less than π. C makes Phi zero in the
/// initial data.
///
/// A screw has e along the axis and rho = pitch/(2 pi); a rack and pinion have e along the rack and rho =
/// radius.
class RotationToTranslation final : public Block {
public:
    RotationToTranslation(int i, const Vec3& s_bar_i, const Vec3& e_bar, const AngleFrame& frame, int j,
                          const Vec3& s_bar_j, const Vec3& a_bar, double rho)
        : Block(i, j), s_bar_i(s_bar_i), s_bar_j(s_bar_j), e_bar(e_bar), a_bar(a_bar), frame(frame), rho(rho)
    {}

    int internal_states() const override { return 1; }
    void update_internal_state(const Arguments& x, bool, double* saved) const override
    {
        saved[0] = angle(x).value;
    }

    double phi(const Arguments& x) const override
    {
        return (x.bi.A * e_bar).dot(d_ij(x)) - rho * angle(x).value - C;
    }

    Variation variation(const Arguments& x) const override
    {
        const Vec3 e = x.bi.A * e_bar;
        const Variation theta = angle(x).variation;
        return {.r_i = -e,
                .pi_i = e_bar.cross(x.bi.A.transpose() * d_ij(x)) - s_bar_i.cross(e_bar) - rho * theta.pi_i,
                .r_j = e,
                .pi_j = s_bar_j.cross(x.bj.A.transpose() * e) - rho * theta.pi_j};
    }

    double gamma(const Arguments& x) const override
    {
        const BodyFixedVector e(x.bi, e_bar), s_i(x.bi, s_bar_i), s_j(x.bj, s_bar_j);
        return -e.centripetal.dot(d_ij(x)) - 2 * e.vdot.dot(x.bj.rdot + s_j.vdot - x.bi.rdot - s_i.vdot) -
               e.v.dot(s_j.centripetal - s_i.centripetal) + rho * angle(x).quadratic;
    }

    double C = 0;  ///< [m]

private:
    Vec3 d_ij(const Arguments& x) const { return x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i; }
    Angle angle(const Arguments& x) const
    {
        return angle_of_vector(frame, x.bi, x.bj, a_bar, x.internal_state ? x.internal_state[0] : 0);
    }

    const Vec3 s_bar_i, s_bar_j, e_bar, a_bar;
    const AngleFrame frame;
    const double rho;
};

}  // namespace hilda::dae
