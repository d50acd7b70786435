// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dae/block.hpp"
#include "dae/driver.hpp"

namespace hilda::dae {

/// Coordinate-difference block: c · d_ij = f(t) along a direction c fixed in the global frame.
///
///     Phi    = c . d_ij - f(t)                                              Fang (2022), Eq. 2.5d
///     d_ij   = r_j + A_j s_bar_j - r_i - A_i s_bar_i
///     Phi_ri = -c^T,   Pi_i =  c^T A_i tilde(s_bar_i)
///     Phi_rj =  c^T,   Pi_j = -c^T A_j tilde(s_bar_j)
class CD final : public Block {
public:
    CD(const Vec3& c, int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, Driver f = {})
        : Block(i, j), c(c), s_bar_i(s_bar_i), s_bar_j(s_bar_j), f(std::move(f)), axis(along_axis(c))
    {}

    double phi(const Motion& bi, const Motion& bj, double t) const override
    {
        return c.dot(bj.r - bi.r) + in_body(bj).dot(s_bar_j) - in_body(bi).dot(s_bar_i) - f.f(t);
    }

    Variation variation(const Motion& bi, const Motion& bj, double) const override
    {
        return {.r_i = -c, .pi_i = in_body(bi).cross(s_bar_i), .r_j = c, .pi_j = s_bar_j.cross(in_body(bj))};
    }

    double nu(const Motion&, const Motion&, double t) const override { return f.fdot(t); }

    double gamma(const Motion& bi, const Motion& bj, double t) const override
    {
        const Carried s_i(bi, s_bar_i), s_j(bj, s_bar_j);
        return f.fddot(t) - c.dot(s_j.centripetal - s_i.centripetal);
    }

    Mat12 second_variation(const Motion& bi, const Motion& bj, double) const override
    {
        Mat12 H = Mat12::Zero();
        H.block<3, 3>(3, 3) = -tilde(s_bar_i) * tilde(in_body(bi));
        H.block<3, 3>(9, 9) = tilde(s_bar_j) * tilde(in_body(bj));
        return H;
    }

    Variation nu_variation(const Motion&, const Motion&, double) const override { return Variation::zero(); }

    GammaChange gamma_variation(const Motion& bi, const Motion& bj, double) const override
    {
        GammaChange g;
        Pull(bi, g.i).centripetal(s_bar_i, c);
        Pull(bj, g.j).centripetal(s_bar_j, -c);
        return g;
    }

    unsigned nonzero() const override
    {
        unsigned axes = 0;
        for (int k = 0; k < 3; ++k)
            if (c[k] != 0) axes |= 1u << k;
        return axes | crossed(s_bar_i) << 3 | axes << 6 | crossed(s_bar_j) << 9;
    }

    std::string objection(const Motion&, const Motion&, double) const override
    {
        return c.norm() > 0 ? "" : "a vector of length zero has no direction, got |c| = 0";
    }

    const Vec3 c, s_bar_i, s_bar_j;
    const Driver f;

private:
    static int along_axis(const Vec3& c)
    {
        for (int k = 0; k < 3; ++k)
            if (c == c[k] * Vec3::Unit(k)) return k;
        return -1;
    }

    /// Aᵀ c: where c lies along a global axis, as in a joint, a row of A
    Vec3 in_body(const Motion& body) const
    {
        if (axis >= 0) return c[axis] * body.A.row(axis).transpose();
        return body.A.transpose() * c;
    }

    const int axis;
};

}  // namespace hilda::dae
