// SPDX-License-Identifier: GPL-3.0-or-later
/// Springs and dampers whose loads are evaluated implicitly in an otherwise half-implicit step.

#pragma once

#include "lie/rows.hpp"

#include <memory>

namespace hilda::lie {

class Saddle;
struct State;
class System;

/// Corrects the explicit loads of the springs of a system (System::spring_pattern()) to implicit ones.
///
/// The loads of a step are evaluated at t_n with the velocities v_n of the node. u is the velocity at the
/// beginning of the step, u' the unknown one at its end. With the stiffness k and the damping c of a row, the
/// correction of its load is the multiplier λ:
///
///     Euler      λ = k (h C u' + h²/2 γ) + c (C u' + h γ - C v_n)
///     midpoint   λ = k/4 (h C (u' - u) + h² γ) + c (θ C u' + (1 - θ) C u + (2θ - 1) h/2 γ - C v_n)
///
/// Both replace S_n by another deflection: Euler by S_{n+1}, midpoint by (S_{n-1} + 2 S_n + S_{n+1})/4, for u
/// and u' at t_n -+ h/2. γ is the change of the rate by the rotation of C at constant velocities, such as
/// |ḋ⊥|²/l of a spring that turns; without it the error of λ would be of the order h² k γ.
///
/// λ is a regularised row of the saddle matrix with the compliance 1/(h d), d = ∂λ/∂(C u') [N s/m]:
///
///     C (h u') - (h² λ)/(h d) = -h λ_0/d,     λ_0 = λ for u' = 0
///
/// Midpoint is the average acceleration method for the spring (Newmark 1959, β = 1/4), which conserves the
/// energy of a linear oscillator. Its damper is fitted to the exponential: with the inverse effective mass W
/// = C M⁻¹ Cᵀ of the bodies without constraints and x = h c W,
///
///     θ(x) = 1/(1 - exp(-x)) - 1/x = 1/2 + x/12 - ...
///
/// A single damper between free bodies then has the exact ratio u'/u = exp(-x). Parallel dampers or
/// constrained bodies may let the velocity oscillate.
///
/// Both rules are stable for every step: the oscillator M S̈ + c Ṡ + k S = 0 has its roots in the closed unit
/// disc for all k ≥ 0, c ≥ 0. This holds along the spring. Across it, a spring with the force f at the length
/// l acts as an explicit spring of stiffness f/l. The correction is of the order h for Euler and h² for
/// midpoint, whatever k and c are, so the scheme keeps its order for loads that depend on S and Ṡ in another
/// way. Derivatives k < 0 or c < 0 are replaced by zero.
class ImplicitSprings {
public:
    enum class Rule { none, euler, midpoint };

    /// The system must outlive the object. With Rule::none, or for a system without springs, there are no
    /// rows.
    ImplicitSprings(const System& system, Rule rule);
    ImplicitSprings(ImplicitSprings&&) noexcept;
    ~ImplicitSprings();

    bool empty() const { return compliances.empty(); }
    const Rows& rows() const { return springs.rows; }
    const std::vector<double>& compliance() const { return compliances; }  ///< 1/(h d) of each row [1/kg]

    /// Evaluates the springs in the state x for a step h from it.
    void start(const State& x, double h);
    /// Replaces the velocities and accelerations of a start x by those of the midpoint rule, from which the
    /// velocity half a step before the start follows:
    ///
    ///     (M + Σ (h² k/4) Cᵀ C) v = M v_0,    (M + Σ h d Cᵀ C) v̇ = M v̇_0 - Σ Cᵀ λ(u = u' = v_n)
    ///
    /// with the constraint rows Φ_r ṙ + Π̄ ω̄ and Φ_r r̈ + Π̄ ω̄̇ unchanged. v is the mean of the velocities
    /// half a step before and after the start. They differ from v_0 and v̇_0 by O(h²) and O(h). Without the
    /// change a motion along a spring that is too fast for the step would have the energy of the mass M + (h²
    /// k/4) Cᵀ C.
    ///
    /// Allocates memory. start() has been called for x.
    void smooth_start(State& x) const;
    /// Replaces the velocities of a node, the means of u and u', by those of the trapezoidal rule: the
    /// inverse of smooth_start(), with the mean rate C (u + u')/2 + h/4 (γ(u') - γ(u)). `history` holds u' of
    /// all bodies, then u, six components per body. The steps before and after the node have the length
    /// `step`.
    void restore_velocities(State& node, const Eigen::VectorXd& history, double step) const;
    /// Writes -h λ_0/d of each row. `before` holds h u and `node` h v_n, six components per body.
    void set_right_side(const Eigen::VectorXd& before, const Eigen::VectorXd& node,
                        Eigen::Ref<Eigen::VectorXd> out) const;

private:
    const System& system;
    const Rule rule;
    Springs springs;
    /// ∂λ/∂γ of row n
    double by_gamma(size_t n) const;

    std::vector<double> compliances, theta;
    std::vector<Mat3> J_bar_inverse;
    double h = 0;

    struct AtNode;
    std::unique_ptr<AtNode> at_node;  ///< workspace of restore_velocities()
};

}  // namespace hilda::lie
