// SPDX-License-Identifier: GPL-3.0-or-later
/// The rp equations at one time, and their exact Newton matrix.  Fang (2022), Eqs. 2.23 to 2.27, 2.30 to 2.32
///
///     e_r = M r̈ + Φ_rᵀ λ - F
///     e_p = 2Gᵀ w + p λ^P,    w = J̄ ω̄̇ + ω̄ × J̄ ω̄ + Π̄ᵀ λ - n̄,    ω̄ = 2G ṗ,  ω̄̇ = 2G p̈
///     e_λ = Φ(r, p, t) / g_q
///     e_P = (pᵀp - 1) / 2g_q
///
/// The unknowns are (r̈, p̈, λ, λ^P). A time-stepping formula gives velocities and positions:
///
///     q̇ = q̇* + g_v q̈,    q = q* + g_q q̈
///
/// e_p is Eq. 2.30b with 2Gᵀ(ω̄ × J̄ ω̄) instead of -8 Ġᵀ J̄ Ġ p. The two terms differ by a multiple of p,
/// which changes λ^P only. With the form above λ^P is zero.
///
/// The Newton matrix is the exact derivative of e. It contains the second variations of the constraints and
/// the derivatives of the loads. An iterate does not satisfy |p| = 1. A is the rotation of p/|p|, so that
/// Φ_p = 2Π̄G/|p|² is exact. With G(a) b = -G(b) a and G(p)ᵀw = Q(w) p, for each body
///
///     ∂e_p = 2Q(w) ∂p + 2Gᵀ ∂w + λ^P ∂p + p ∂λ^P
///     ∂w   = 2J̄ (G ∂p̈ - G(p̈) ∂p) + (ω̄~ J̄ - (J̄ω̄)~) ∂ω̄ + ∂(Π̄ᵀλ - n̄),    ∂ω̄ = 2G ∂ṗ - 2G(ṗ) ∂p
///
/// ∂(Φ_rᵀλ - F) and ∂(Π̄ᵀλ - n̄) are the variations of the system with δθ̄ = 2G ∂p/|p|².

#pragma once

#include "lie/loads.hpp"
#include "lie/rows.hpp"
#include "lie/solver/newton_matrix.hpp"
#include "reference/formulations/rp.hpp"

#include <vector>

namespace hilda::lie {
class System;
}

namespace hilda::reference {

/// The time-stepping formula, with q = (r, p): seven components per body
struct RpFormula {
    Eigen::VectorXd q, qdot;  ///< q*, q̇*
    double g_q = 0, g_v = 0;  ///< [s²], [s]
};

class RpStepEquations {
public:
    explicit RpStepEquations(const lie::System& model);

    int size() const { return 8 * bodies + rows; }
    int at_lambda() const { return 7 * bodies; }
    int at_norm() const { return 7 * bodies + rows; }

    /// Sets the positions, velocities and accelerations of x from z. p(i) and pdot(i) are then those of body
    /// i.
    void place(const RpFormula& formula, const Eigen::VectorXd& z, lie::State& x);
    lie::Vec4 p(int i) const { return q.segment<4>(7 * i + 3); }
    lie::Vec4 pdot(int i) const { return qdot.segment<4>(7 * i + 3); }

    /// Computes the residual e of z. x is the result of place().
    void residual(const RpFormula& formula, const Eigen::VectorXd& z, const lie::State& x,
                  Eigen::VectorXd& e);

    /// Sets N = ∂e/∂z, for the arguments of the last residual().                                     Eq. 2.32
    void assemble(const RpFormula& formula, const Eigen::VectorXd& z, const lie::State& x);

    lie::NewtonMatrix N;

private:
    using Mat7 = Eigen::Matrix<double, 7, 7>;

    /// S = ∂(Φ_rᵀλ - F, Π̄ᵀλ - n̄ of body `on`)/∂(δr, δθ̄, δṙ, δω̄ of body `by`); `at` is its block of N
    struct Pair {
        int on = 0, by = 0, at = 0;
        Eigen::Matrix<double, 6, 12> S = Eigen::Matrix<double, 6, 12>::Zero();
    };

    int pair_of(int on, int by);  ///< index of the pair, which is added if it does not exist
    void set_variations(const lie::State& x);
    /// Sets V[i], the derivative of (δr, δθ̄, δṙ, δω̄) of body i by its (∂r̈, ∂p̈).
    void set_map(int i, const RpFormula& f);
    void add_inertia(int i, const RpFormula& f, const Eigen::VectorXd& z, const lie::Motion& body,
                     Mat7& block) const;

    const lie::System& model;
    const int bodies, rows;
    lie::Rows C;
    lie::SecondVariation H;
    lie::LoadVariation D;
    lie::Loads loads;
    std::vector<lie::Vec3> w;
    Eigen::VectorXd q, qdot, Ct_lambda;
    std::vector<Eigen::Matrix<double, 12, 7>> V;
    std::vector<Pair> pairs;
    std::vector<int> pair_of_variation, pair_of_load;
    std::vector<int> upper, lower, norm_column, norm_row;
};

}  // namespace hilda::reference
