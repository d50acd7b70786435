// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint DP2: dot product of a body-fixed vector and the vector between two points.
#pragma once

#include "dae/block.hpp"
#include "dae/block_terms.hpp"
#include "dae/driver.hpp"

namespace hilda::dae {

/// Second dot-product block: a_i · d_ij = f(t), with the vector d_ij from point P of body i to point Q of
/// body j.
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

    double phi(const Arguments& x) const override
    {
        const Vec3 d_ij = x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i;
        return (x.bi.A * a_bar_i).dot(d_ij) - f.f(x.t);
    }

    Variation variation(const Arguments& x) const override
    {
        const Vec3 a_i = x.bi.A * a_bar_i;
        const Vec3 d_ij = x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i;
        return {.r_i = -a_i,
                .pi_i = a_bar_i.cross(s_bar_i) + a_bar_i.cross(x.bi.A.transpose() * d_ij),
                .r_j = a_i,
                .pi_j = s_bar_j.cross(x.bj.A.transpose() * a_i)};
    }

    double nu(const Arguments& x) const override { return f.fdot(x.t); }

    double gamma(const Arguments& x) const override
    {
        const BodyFixedVector a_i(x.bi, a_bar_i), s_i(x.bi, s_bar_i), s_j(x.bj, s_bar_j);
        const Vec3 d_ij = x.bj.r + s_j.v - x.bi.r - s_i.v;
        const Vec3 d_ijdot = x.bj.rdot + s_j.vdot - x.bi.rdot - s_i.vdot;
        return f.fddot(x.t) - a_i.centripetal.dot(d_ij) - 2 * a_i.vdot.dot(d_ijdot) -
               a_i.v.dot(s_j.centripetal - s_i.centripetal);
    }

    Mat12 second_variation(const Arguments& x) const override
    {
        const Vec3 d_ij = x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i;
        const Mat3 ai = tilde(a_bar_i), sj = tilde(s_bar_j), A_ai = x.bi.A * ai;
        Mat12 H = Mat12::Zero();
        H.block<3, 3>(0, 3) = A_ai;
        H.block<3, 3>(6, 3) = -A_ai;
        H.block<3, 3>(3, 0) = A_ai.transpose();
        H.block<3, 3>(3, 6) = -A_ai.transpose();
        H.block<3, 3>(3, 3) = ai * (tilde(x.bi.A.transpose() * d_ij) + tilde(s_bar_i));
        H.block<3, 3>(3, 9) = A_ai.transpose() * x.bj.A * sj;
        H.block<3, 3>(9, 3) = H.block<3, 3>(3, 9).transpose();
        H.block<3, 3>(9, 9) = sj * tilde(x.bj.A.transpose() * (x.bi.A * a_bar_i));
        return H;
    }

    Variation nu_variation(const Arguments&) const override { return Variation::zero(); }

    GammaDerivatives gamma_variation(const Arguments& x) const override
    {
        const BodyFixedVector a_i(x.bi, a_bar_i), s_i(x.bi, s_bar_i), s_j(x.bj, s_bar_j);
        const Vec3 d_ij = x.bj.r + s_j.v - x.bi.r - s_i.v;
        const Vec3 d_ijdot = x.bj.rdot + s_j.vdot - x.bi.rdot - s_i.vdot;
        GammaDerivatives g;
        GammaTerms terms_i(x.bi, g.i), terms_j(x.bj, g.j);
        terms_i.centripetal(a_bar_i, -d_ij);
        terms_i.adot(a_bar_i, -2 * d_ijdot);
        terms_i.a(a_bar_i, s_i.centripetal - s_j.centripetal);
        g.j.r = -a_i.centripetal, g.i.r = -g.j.r;
        terms_j.a(s_bar_j, g.j.r), terms_i.a(s_bar_i, g.i.r);
        g.j.rdot = -2 * a_i.vdot, g.i.rdot = -g.j.rdot;
        terms_j.adot(s_bar_j, g.j.rdot), terms_i.adot(s_bar_i, g.i.rdot);
        terms_j.centripetal(s_bar_j, -a_i.v), terms_i.centripetal(s_bar_i, a_i.v);
        return g;
    }

    const Driver* prescribed() const override { return f.is_constant() ? nullptr : &f; }

    unsigned nonzero() const override
    {
        return 0b111 | cross_product_pattern(a_bar_i) << 3 | 0b111 << 6 | cross_product_pattern(s_bar_j) << 9;
    }

    std::optional<PointPair> points() const override { return PointPair{i, j, s_bar_i, s_bar_j}; }

    std::string start_error(const Arguments&) const override
    {
        return a_bar_i.norm() > 0 ? "" : "a vector of length zero has no direction, got |a_i| = 0";
    }

    const Vec3 a_bar_i, s_bar_i, s_bar_j;
    const Driver f;
};

}  // namespace hilda::dae
