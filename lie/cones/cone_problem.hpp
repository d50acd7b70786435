// SPDX-License-Identifier: GPL-3.0-or-later
/// Velocities and impulses of bodies with joints and rigid contacts.

#pragma once

#include "lie/cones/cone_rows.hpp"
#include "lie/cones/coulomb_cone.hpp"
#include "lie/loads.hpp"
#include "lie/rows.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <vector>

namespace hilda::lie {

/// The problem
///
///     M v + C_bᵀ λ - Σ_c C_cᵀ p_c = q,     C_b v = ν
///     u_c = C_c v,     p_c ∈ K_μ,     û_c = u_c + (μ |u_t| + β) n ∈ K_μ*,     p_c · û_c = 0
///
/// with the unknowns v = (ṙ, ω̄) of all bodies, λ of the joint rows and p_c of the contact points. M = diag(m
/// I, J̄) is constant in the body frames. Without joints the velocity without contacts is v* = M⁻¹ q, and for
/// given slip terms s = μ |u_t| the problem is the convex one
///
///     min ½ |v - v*|²_M     subject to  C_b v = ν,  C_c v + (s + β) n ∈ K_μ*
///
/// The residual of the law is the natural map, a velocity in m/s:
///
///     max_c g_c |p_c - Π(p_c - û_c/g_c)|,     g_c = tr(C_c M⁻¹ C_cᵀ)/3     Π: projection onto K_μ
///
/// It is zero for a solution and only then. g_c is the inverse of the mass that the contact point accelerates
/// [1/kg]. For μ = 0 it is that of the normal row, the only one that counts then.
///
/// All vectors keep their memory.
struct ConeProblem {
    using Vec6 = Eigen::Matrix<double, 6, 1>;
    using Cones = std::vector<ConeRows::Cone>;

    /// The unknowns, and the slip terms s of the convex problem that a method has solved
    struct Iterate {
        Eigen::VectorXd y;           ///< v of all bodies, six components each, then λ
        std::vector<Vec3> p;         ///< (p_n, p_t1, p_t2) [N s]
        std::vector<double> offset;  ///< s + β [m/s]
        double residual = 0;         ///< of the law and of the joint rows [m/s; rad/s]
    };

    ConeProblem(const Mass& mass, const Rows& pattern);

    /// Sets the scales g_c from the contact points and the coefficients of friction.
    void set_scales();
    int contacts() const { return static_cast<int>(cones->size()); }
    int bodies() const { return static_cast<int>(mass.m.size()); }
    int unknowns() const { return 6 * bodies() + C_b->rows(); }

    /// u of contact point c for the velocities in y
    Vec3 u(int c, const Eigen::VectorXd& y) const;
    /// û of contact point c with its slip term
    Vec3 u_hat(int c, const Eigen::VectorXd& y) const
    {
        Vec3 of = u(c, y);
        of[0] += beta[c] + slip_term(c, of);
        return of;
    }
    double slip_term(int c, const Vec3& of_u) const { return mu[c] * tangential(of_u); }
    /// |p - Π(p - w/g)| g of contact point c for the impulse p and the velocity w, at least its rounding
    /// error: without it, impulses of 10¹⁶ N s would solve problems that have no solution
    double natural_map(int c, const Vec3& p, const Vec3& w) const
    {
        const double error = (p - project_on_cone(p - w / g[c], mu[c])).norm();
        return g[c] * std::max(error, std::numeric_limits<double>::epsilon() * p.norm());
    }
    /// out += factor C_cᵀ p
    void add_impulse(int c, const Vec3& p, Eigen::VectorXd& out) const;
    /// q + Σ C_cᵀ p_c, then ν
    void set_right_side(const std::vector<Vec3>& p, Eigen::VectorXd& out) const;

    /// Residual of the law and of the joint rows
    double residual(const Iterate& x) const;
    /// The same for the convex problem with the offsets of x
    double convex_residual(const Iterate& x) const;
    /// Contact point with the largest residual of the law; -1 without contact points
    int worst_contact(const Iterate& x) const;
    /// Largest |C_b v - ν|
    double joint_residual(const Eigen::VectorXd& y) const;
    /// M⁻¹ of the components of body b
    Vec6 by_mass(int b, const Vec6& of) const;
    Vec6 times_mass(int b, const Vec6& of) const;

    const Mass& mass;
    std::vector<Mat3> J_bar_inverse;
    const Rows* C_b;               ///< the joint rows
    const Cones* cones = nullptr;  ///< the contact points
    std::vector<double> mu, beta;  ///< of each contact point
    std::vector<double> g;         ///< set_scales()
    Eigen::VectorXd q;             ///< [N s; N m s], six components per body
    Eigen::VectorXd nu;            ///< [m/s], one component per joint row
};

}  // namespace hilda::lie
