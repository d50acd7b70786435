// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint D: squared distance.
#pragma once

#include "dae/block.hpp"
#include "dae/block_terms.hpp"
#include "dae/driver.hpp"

#include <sstream>

namespace hilda::dae {

/// Distance block: d_ij · d_ij = f(t), the squared distance [m²] of point P of body i and point Q of body j.
///
///     Phi    = d_ij . d_ij - f(t)                                           Fang (2022), Eq. 2.5c
///     d_ij   = r_j + A_j s_bar_j - r_i - A_i s_bar_i
///     Phi_ri = -2 d_ij^T,   Pi_i =  2 d_ij^T A_i tilde(s_bar_i)
///     Phi_rj =  2 d_ij^T,   Pi_j = -2 d_ij^T A_j tilde(s_bar_j)
///
/// Phi_rj has the length 2 |d_ij|. The multiplier is therefore a force divided by 2 |d_ij| [N/m]. The row
/// loses rank at the distance zero.
class D final : public Block {
public:
    D(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, Driver f)
        : Block(i, j), s_bar_i(s_bar_i), s_bar_j(s_bar_j), f(std::move(f))
    {}

    double phi(const Arguments& x) const override
    {
        return (x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i).squaredNorm() - f.f(x.t);
    }

    Variation variation(const Arguments& x) const override
    {
        const Vec3 d_ij = x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i;
        return {.r_i = -2 * d_ij,
                .pi_i = -2 * s_bar_i.cross(x.bi.A.transpose() * d_ij),
                .r_j = 2 * d_ij,
                .pi_j = 2 * s_bar_j.cross(x.bj.A.transpose() * d_ij)};
    }

    double nu(const Arguments& x) const override { return f.fdot(x.t); }

    double gamma(const Arguments& x) const override
    {
        const BodyFixedVector s_i(x.bi, s_bar_i), s_j(x.bj, s_bar_j);
        const Vec3 d_ij = x.bj.r + s_j.v - x.bi.r - s_i.v;
        const Vec3 d_ijdot = x.bj.rdot + s_j.vdot - x.bi.rdot - s_i.vdot;
        return f.fddot(x.t) - 2 * d_ijdot.squaredNorm() - 2 * d_ij.dot(s_j.centripetal - s_i.centripetal);
    }

    Mat12 second_variation(const Arguments& x) const override
    {
        const Vec3 d_ij = x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i;
        const Vec3 d_bar_i = x.bi.A.transpose() * d_ij, d_bar_j = x.bj.A.transpose() * d_ij;
        const Mat3 si = tilde(s_bar_i), sj = tilde(s_bar_j), A_si = x.bi.A * si, A_sj = x.bj.A * sj;
        Mat12 H;
        // clang-format off
        H <<  Mat3::Identity(),                       -A_si, -Mat3::Identity(),                       A_sj,
             -A_si.transpose(), -si * (tilde(d_bar_i) + si),  A_si.transpose(),   -A_si.transpose() * A_sj,
             -Mat3::Identity(),                        A_si,  Mat3::Identity(),                      -A_sj,
              A_sj.transpose(),    -A_sj.transpose() * A_si, -A_sj.transpose(), sj * (tilde(d_bar_j) - sj);
        // clang-format on
        return 2 * H;
    }

    Variation nu_variation(const Arguments&) const override { return Variation::zero(); }

    GammaDerivatives gamma_variation(const Arguments& x) const override
    {
        const BodyFixedVector s_i(x.bi, s_bar_i), s_j(x.bj, s_bar_j);
        const Vec3 d_ij = x.bj.r + s_j.v - x.bi.r - s_i.v;
        GammaDerivatives g;
        GammaTerms terms_i(x.bi, g.i), terms_j(x.bj, g.j);
        g.j.r = -2 * (s_j.centripetal - s_i.centripetal), g.i.r = -g.j.r;
        terms_j.a(s_bar_j, g.j.r), terms_i.a(s_bar_i, g.i.r);
        g.j.rdot = -4 * (x.bj.rdot + s_j.vdot - x.bi.rdot - s_i.vdot), g.i.rdot = -g.j.rdot;
        terms_j.adot(s_bar_j, g.j.rdot), terms_i.adot(s_bar_i, g.i.rdot);
        terms_j.centripetal(s_bar_j, -2 * d_ij), terms_i.centripetal(s_bar_i, 2 * d_ij);
        return g;
    }

    const Driver* prescribed() const override { return f.is_constant() ? nullptr : &f; }

    unsigned nonzero() const override
    {
        return 0b111 | cross_product_pattern(s_bar_i) << 3 | 0b111 << 6 | cross_product_pattern(s_bar_j) << 9;
    }

    std::optional<PointPair> points() const override { return PointPair{i, j, s_bar_i, s_bar_j}; }

    std::string start_error(const Arguments& x) const override
    {
        std::ostringstream text;
        if (!(f.f(x.t) > 0)) text << "f is a squared distance and must be positive, got " << f.f(x.t);
        return text.str();
    }

    const Vec3 s_bar_i, s_bar_j;
    const Driver f;
};

}  // namespace hilda::dae
