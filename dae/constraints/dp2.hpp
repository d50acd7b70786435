// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dae/block.hpp"
#include "dae/driver.hpp"

namespace hilda::dae {

/// Second dot-product block: a_i · d_ij = f(t), with d_ij from point P of body i to point Q of body j.
///
///     Phi    = (A_i a_bar_i) . d_ij - f(t)                                  Fang (2022), Eq. 2.5b
///     d_ij   = r_j + A_j s_bar_j - r_i - A_i s_bar_i
///     Phi_ri = -a_i^T,   Pi_i = a_bar_i^T tilde(s_bar_i) - d_ij^T A_i tilde(a_bar_i)
///     Phi_rj =  a_i^T,   Pi_j = -a_i^T A_j tilde(s_bar_j)
class DP2 final : public Block {
public:
    DP2(int i, const Vec3& a_bar_i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, Driver f = {})
        : Block(i, j), a_bar_i(a_bar_i), s_bar_i(s_bar_i), s_bar_j(s_bar_j), f(std::move(f))
    {}

    double phi(const Motion& bi, const Motion& bj, double t) const override
    {
        const Vec3 d_ij = bj.r + bj.A * s_bar_j - bi.r - bi.A * s_bar_i;
        return (bi.A * a_bar_i).dot(d_ij) - f.f(t);
    }

    Variation variation(const Motion& bi, const Motion& bj, double) const override
    {
        const Vec3 a_i = bi.A * a_bar_i;
        const Vec3 d_ij = bj.r + bj.A * s_bar_j - bi.r - bi.A * s_bar_i;
        return {.r_i = -a_i,
                .pi_i = a_bar_i.cross(s_bar_i) + a_bar_i.cross(bi.A.transpose() * d_ij),
                .r_j = a_i,
                .pi_j = s_bar_j.cross(bj.A.transpose() * a_i)};
    }

    double nu(const Motion&, const Motion&, double t) const override { return f.fdot(t); }

    double gamma(const Motion& bi, const Motion& bj, double t) const override
    {
        const Carried a_i(bi, a_bar_i), s_i(bi, s_bar_i), s_j(bj, s_bar_j);
        const Vec3 d_ij = bj.r + s_j.v - bi.r - s_i.v;
        const Vec3 d_ijdot = bj.rdot + s_j.vdot - bi.rdot - s_i.vdot;
        return f.fddot(t) - a_i.centripetal.dot(d_ij) - 2 * a_i.vdot.dot(d_ijdot) -
               a_i.v.dot(s_j.centripetal - s_i.centripetal);
    }

    unsigned nonzero() const override
    {
        return 0b111 | crossed(a_bar_i) << 3 | 0b111 << 6 | crossed(s_bar_j) << 9;
    }

    std::string objection(const Motion&, const Motion&, double) const override
    {
        return a_bar_i.norm() > 0 ? "" : "a vector of length zero has no direction, got |a_i| = 0";
    }

    const Vec3 a_bar_i, s_bar_i, s_bar_j;
    const Driver f;
};

}  // namespace hilda::dae
