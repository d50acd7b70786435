// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint DrivenHinge: prescribed rotation about an axis, over any number of revolutions.
#pragma once

#include "dae/block.hpp"
#include "dae/block_terms.hpp"
#include "dae/driver.hpp"
#include "io/arithmetic/jet.hpp"

namespace hilda::dae {

/// Rotates body j about an axis of body i by the angle g(t) - g(t_0) since the start.
///
/// The vector w is fixed in body j and perpendicular to the axis. The vector b(t) rotates in body i, 90
/// degrees ahead of the prescribed direction of w:
///
///     Phi  = (A_i b_bar(t)) . (A_j w_bar),    b_bar = u_bar' cos g - u_bar sin g
///     Pi_i = -w^T A_i tilde(b_bar),   Pi_j = -b^T A_j tilde(w_bar),   nu = -(A_i d/dt b_bar) . w
///
/// u_bar, u_bar' and the axis are right-handed and orthonormal. The row has length one at every angle. A DP1
/// driver in its place would lose rank twice per revolution.
class DrivenHinge final : public Block {
public:
    /// u_bar and u_bar_prime: perpendicular unit vectors in the frame of body i. w_bar: unit vector in the
    /// frame of body j. At the start it encloses the angle g(t_0) with u_bar, positive towards u_bar_prime.
    DrivenHinge(int i, const Vec3& u_bar, const Vec3& u_bar_prime, int j, const Vec3& w_bar, Driver g)
        : Block(i, j), u_bar(u_bar), u_bar_prime(u_bar_prime), w_bar(w_bar), g(std::move(g))
    {}

    double phi(const Arguments& x) const override { return (x.bi.A * b_bar(x.t).b).dot(x.bj.A * w_bar); }

    Variation variation(const Arguments& x) const override
    {
        const Vec3 b = b_bar(x.t).b, w = x.bj.A * w_bar;
        return {.r_i = Vec3::Zero(),
                .pi_i = b.cross(x.bi.A.transpose() * w),
                .r_j = Vec3::Zero(),
                .pi_j = w_bar.cross(x.bj.A.transpose() * (x.bi.A * b))};
    }

    double nu(const Arguments& x) const override { return -(x.bi.A * b_bar(x.t).bdot).dot(x.bj.A * w_bar); }

    double gamma(const Arguments& x) const override
    {
        const DrivenVector b = b_bar(x.t);
        const BodyFixedVector w(x.bj, w_bar);
        const Vec3& omega_bar = x.bi.omega_bar;
        const Vec3 bdot = x.bi.A * (omega_bar.cross(b.b) + b.bdot);
        const Vec3 bddot = x.bi.A * (omega_bar.cross(omega_bar.cross(b.b) + 2 * b.bdot) + b.bddot);
        return -bddot.dot(w.v) - 2 * bdot.dot(w.vdot) - (x.bi.A * b.b).dot(w.centripetal);
    }

    Mat12 second_variation(const Arguments& x) const override
    {
        const Vec3 b = b_bar(x.t).b;
        const Mat3 b_tilde = tilde(b), w_tilde = tilde(w_bar), A_ij = x.bi.A.transpose() * x.bj.A;
        Mat12 H = Mat12::Zero();
        H.block<3, 3>(3, 3) = b_tilde * tilde(A_ij * w_bar);
        H.block<3, 3>(3, 9) = -b_tilde * A_ij * w_tilde;
        H.block<3, 3>(9, 3) = H.block<3, 3>(3, 9).transpose();
        H.block<3, 3>(9, 9) = w_tilde * tilde(A_ij.transpose() * b);
        return H;
    }

    Variation nu_variation(const Arguments& x) const override
    {
        const Vec3 bdot = b_bar(x.t).bdot;
        return {.r_i = Vec3::Zero(),
                .pi_i = -bdot.cross(x.bi.A.transpose() * (x.bj.A * w_bar)),
                .r_j = Vec3::Zero(),
                .pi_j = -w_bar.cross(x.bj.A.transpose() * (x.bi.A * bdot))};
    }

    GammaDerivatives gamma_variation(const Arguments& x) const override
    {
        const DrivenVector b = b_bar(x.t);
        const BodyFixedVector w(x.bj, w_bar);
        const Vec3& omega_bar = x.bi.omega_bar;
        const Vec3 first = omega_bar.cross(b.b) + b.bdot, inner = omega_bar.cross(b.b) + 2 * b.bdot,
                   second = omega_bar.cross(inner) + b.bddot;
        GammaDerivatives g;
        const Vec3 g_0 = x.bi.A.transpose() * -w.centripetal, g_1 = x.bi.A.transpose() * (-2 * w.vdot),
                   g_2 = x.bi.A.transpose() * -w.v;
        g.i.theta = b.b.cross(g_0) + first.cross(g_1) + second.cross(g_2);
        g.i.omega = b.b.cross(g_1) + inner.cross(g_2) + b.b.cross(g_2.cross(omega_bar));
        GammaTerms terms_j(x.bj, g.j);
        terms_j.a(w_bar, -(x.bi.A * second));
        terms_j.adot(w_bar, -2 * (x.bi.A * first));
        terms_j.centripetal(w_bar, -(x.bi.A * b.b));
        return g;
    }

    const Driver* prescribed() const override { return g.is_constant() ? nullptr : &g; }

    unsigned nonzero() const override
    {
        return (cross_product_pattern(u_bar) | cross_product_pattern(u_bar_prime)) << 3 |
               cross_product_pattern(w_bar) << 9;
    }

    const Vec3 u_bar, u_bar_prime, w_bar;
    const Driver g;

private:
    /// b̄ and its time derivatives in the frame of body i
    struct DrivenVector {
        Vec3 b, bdot, bddot;
    };
    DrivenVector b_bar(double t) const
    {
        const io::Jet a = g.jet(t);
        const double c = std::cos(a.f), s = std::sin(a.f);
        const Vec3 b = c * u_bar_prime - s * u_bar;
        const Vec3 db_dg = -s * u_bar_prime - c * u_bar;
        return {b, a.fdot * db_dg, a.fddot * db_dg - a.fdot * a.fdot * b};
    }
};

}  // namespace hilda::dae
