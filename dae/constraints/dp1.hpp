// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint DP1: dot product of two body-fixed vectors.
#pragma once

#include "dae/block.hpp"
#include "dae/block_terms.hpp"
#include "dae/driver.hpp"

#include <memory>
#include <optional>
#include <sstream>

namespace hilda::dae {

/// First dot-product block: a_i · a_j = f(t), the angle between two body-fixed vectors.
///
///     Phi    = (A_i a_bar_i) . (A_j a_bar_j) - f(t)                         Fang (2022), Eq. 2.5a
///     Pi_i   = -a_j^T A_i tilde(a_bar_i),   Pi_j = -a_i^T A_j tilde(a_bar_j)
///
/// The row loses rank where the two vectors are parallel, |f| = |a_i| |a_j|. A driver that passes such a
/// point is replaced by its complement near it.
class DP1 final : public Block {
public:
    DP1(int i, const Vec3& a_bar_i, int j, const Vec3& a_bar_j, Driver f = {})
        : Block(i, j), a_bar_i(a_bar_i), a_bar_j(a_bar_j), f(std::move(f))
    {}

    double phi(const Arguments& x) const override
    {
        return (x.bi.A * a_bar_i).dot(x.bj.A * a_bar_j) - f.f(x.t);
    }

    Variation variation(const Arguments& x) const override
    {
        const Vec3 a_i = x.bi.A * a_bar_i, a_j = x.bj.A * a_bar_j;
        return {.r_i = Vec3::Zero(),
                .pi_i = a_bar_i.cross(x.bi.A.transpose() * a_j),
                .r_j = Vec3::Zero(),
                .pi_j = a_bar_j.cross(x.bj.A.transpose() * a_i)};
    }

    double nu(const Arguments& x) const override { return f.fdot(x.t); }

    double gamma(const Arguments& x) const override
    {
        const BodyFixedVector a_i(x.bi, a_bar_i), a_j(x.bj, a_bar_j);
        return f.fddot(x.t) - a_i.centripetal.dot(a_j.v) - a_i.v.dot(a_j.centripetal) -
               2 * a_i.vdot.dot(a_j.vdot);
    }

    Mat12 second_variation(const Arguments& x) const override
    {
        const Mat3 ai = tilde(a_bar_i), aj = tilde(a_bar_j), A_ij = x.bi.A.transpose() * x.bj.A;
        Mat12 H = Mat12::Zero();
        H.block<3, 3>(3, 3) = ai * tilde(A_ij * a_bar_j);
        H.block<3, 3>(3, 9) = -ai * A_ij * aj;
        H.block<3, 3>(9, 3) = H.block<3, 3>(3, 9).transpose();
        H.block<3, 3>(9, 9) = aj * tilde(A_ij.transpose() * a_bar_i);
        return H;
    }

    Variation nu_variation(const Arguments&) const override { return Variation::zero(); }

    GammaDerivatives gamma_variation(const Arguments& x) const override
    {
        const BodyFixedVector a_i(x.bi, a_bar_i), a_j(x.bj, a_bar_j);
        GammaDerivatives g;
        const auto add_terms = [](GammaTerms terms, const Vec3& a_bar, const BodyFixedVector& other) {
            terms.centripetal(a_bar, -other.v);
            terms.a(a_bar, -other.centripetal);
            terms.adot(a_bar, -2 * other.vdot);
        };
        add_terms(GammaTerms(x.bi, g.i), a_bar_i, a_j);
        add_terms(GammaTerms(x.bj, g.j), a_bar_j, a_i);
        return g;
    }

    const Driver* prescribed() const override { return f.is_constant() ? nullptr : &f; }

    unsigned nonzero() const override
    {
        return cross_product_pattern(a_bar_i) << 3 | cross_product_pattern(a_bar_j) << 9;
    }

    std::string start_error(const Arguments& x) const override
    {
        const double max_value = a_bar_i.norm() * a_bar_j.norm(), value = f.f(x.t);
        std::ostringstream text;
        if (!(max_value > 0))
            text << "a vector of length zero has no direction, got |a_i||a_j| = " << max_value;
        else if (std::abs(value) > max_value)
            text << "f must be between -|a_i||a_j| and |a_i||a_j| = " << max_value << ", got " << value;
        else if (max_value - std::abs(value) < 1e-9 * max_value)
            text << "the two vectors are parallel at the start (|f| = |a_i||a_j|), where the DP1 row is "
                    "singular, got f = "
                 << value;
        return text.str();
    }

    /// |f| / (|a_i| |a_j|): 1 where the vectors are parallel and the row loses rank
    double alignment(double t) const { return std::abs(f.f(t)) / (a_bar_i.norm() * a_bar_j.norm()); }

    /// The block that drives the same rotation where this one is singular, or nullptr if f is neither cos(g)
    /// nor sin(g).
    ///
    /// Let the two vectors have length one and stay in one plane. Then a_i · a_j = cos g implies p · a_j = ±
    /// sin g for the vector p = (a_i × a_j) × a_i, scaled to the length of a_i. p is fixed in body i. Its
    /// direction and its sign are those at the start.
    std::unique_ptr<DP1> complement(const Arguments& x) const
    {
        const std::optional<Driver> other = f.complement();
        if (!other) return nullptr;
        const Vec3 a_j = x.bi.A.transpose() * (x.bj.A * a_bar_j);
        const Vec3 axis = a_bar_i.cross(a_j).normalized();
        Vec3 a_bar_perpendicular = axis.cross(a_bar_i);
        const double sine = a_bar_perpendicular.dot(a_j);  // positive, since axis is along a_i × a_j
        if (other->f(x.t) * sine < 0) a_bar_perpendicular = -a_bar_perpendicular;
        return std::make_unique<DP1>(i, a_bar_perpendicular, j, a_bar_j, *other);
    }

    const Vec3 a_bar_i, a_bar_j;
    const Driver f;
};

}  // namespace hilda::dae
