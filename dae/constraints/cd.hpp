// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint CD: coordinate difference.
#pragma once

#include "dae/block.hpp"
#include "dae/block_terms.hpp"
#include "dae/driver.hpp"

namespace hilda::dae {

/// Coordinate-difference block: c · d_ij = f(t), with a direction c fixed in the global frame and the vector
/// d_ij from point P of body i to point Q of body j.
///
///     Phi    = c . d_ij - f(t)                                              Fang (2022), Eq. 2.5d
///     d_ij   = r_j + A_j s_bar_j - r_i - A_i s_bar_i
///     Phi_ri = -c^T,   Pi_i =  c^T A_i tilde(s_bar_i)
///     Phi_rj =  c^T,   Pi_j = -c^T A_j tilde(s_bar_j)
///
/// s_bar_i and s_bar_j are the positions of P and Q in the body frames [m].
class CD final : public Block {
public:
    CD(const Vec3& c, int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, Driver f = {})
        : Block(i, j), c(c), s_bar_i(s_bar_i), s_bar_j(s_bar_j), f(std::move(f)), global_axis(axis_of(c))
    {}

    double phi(const Arguments& x) const override
    {
        return c.dot(x.bj.r - x.bi.r) + in_body(x.bj).dot(s_bar_j) - in_body(x.bi).dot(s_bar_i) - f.f(x.t);
    }

    Variation variation(const Arguments& x) const override
    {
        return {
            .r_i = -c, .pi_i = in_body(x.bi).cross(s_bar_i), .r_j = c, .pi_j = s_bar_j.cross(in_body(x.bj))};
    }

    double nu(const Arguments& x) const override { return f.fdot(x.t); }

    double gamma(const Arguments& x) const override
    {
        const auto centripetal = [this](const Motion& body, const Vec3& s_bar) {  // c . A (w x (w x s_bar))
            return in_body(body).dot(body.omega_bar.cross(body.omega_bar.cross(s_bar)));
        };
        return f.fddot(x.t) - (centripetal(x.bj, s_bar_j) - centripetal(x.bi, s_bar_i));
    }

    Mat12 second_variation(const Arguments& x) const override
    {
        Mat12 H = Mat12::Zero();
        H.block<3, 3>(3, 3) = -tilde(s_bar_i) * tilde(in_body(x.bi));
        H.block<3, 3>(9, 9) = tilde(s_bar_j) * tilde(in_body(x.bj));
        return H;
    }

    Variation nu_variation(const Arguments&) const override { return Variation::zero(); }

    GammaDerivatives gamma_variation(const Arguments& x) const override
    {
        GammaDerivatives g;
        GammaTerms(x.bi, g.i).centripetal(s_bar_i, c);
        GammaTerms(x.bj, g.j).centripetal(s_bar_j, -c);
        return g;
    }

    const Driver* prescribed() const override { return f.is_constant() ? nullptr : &f; }

    std::optional<PointRow> point_row() const override
    {
        if (global_axis < 0 || !f.is_constant()) return {};
        return PointRow{i, j, s_bar_i, s_bar_j, global_axis, c[global_axis], f.f(0)};
    }

    unsigned nonzero() const override
    {
        unsigned axes = 0;
        for (int k = 0; k < 3; ++k)
            if (c[k] != 0) axes |= 1u << k;
        return axes | cross_product_pattern(s_bar_i) << 3 | axes << 6 | cross_product_pattern(s_bar_j) << 9;
    }

    std::optional<PointPair> points() const override { return PointPair{i, j, s_bar_i, s_bar_j}; }

    std::string start_error(const Arguments&) const override
    {
        return c.norm() > 0 ? "" : "a vector of length zero has no direction, got |c| = 0";
    }

    const Vec3 c, s_bar_i, s_bar_j;
    const Driver f;

private:
    /// Number of the global axis to which c is parallel, or -1
    static int axis_of(const Vec3& c)
    {
        for (int k = 0; k < 3; ++k)
            if (c == c[k] * Vec3::Unit(k)) return k;
        return -1;
    }

    /// Aᵀ c. If c is parallel to a global axis, as in all joints, it is a multiple of a row of A.
    Vec3 in_body(const Motion& body) const
    {
        if (global_axis >= 0) return c[global_axis] * body.A.row(global_axis).transpose();
        return body.A.transpose() * c;
    }

    const int global_axis;
};

}  // namespace hilda::dae
