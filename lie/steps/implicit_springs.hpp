// SPDX-License-Identifier: GPL-3.0-or-later
/// Springs and dampers whose loads are evaluated implicitly in an otherwise half-implicit step.

#pragma once

#include "lie/springs.hpp"

#include <memory>

namespace hilda::lie {

class Saddle;
struct State;
class System;

/// Corrects the explicit loads of the springs of a system (System::spring_pattern()) to implicit ones.
///
/// The loads of a step are evaluated at t_n with the velocities v_n of the node. u is the velocity at the
/// beginning of the step, u' the unknown one at its end. With the stiffness k and the damping c of a row, the
/// correction of its load is the multiplier
///
///     λ = h k (β' C u' - β C u) + c (σ' C u' + σ C u - C v_n)
///
/// It is a regularised row of the saddle matrix with the compliance 1/(h d), d = h k β' + c σ' [N s/m]:
///
///     C (h u') - (h² λ)/(h d) = -h λ_0/d,     λ_0 = -h k β C u + c (σ C u - C v_n)
///
/// The rules of the two kinds of schemes:
///
///     Euler      β' = σ' = 1,     β = σ = 0           backward Euler: load at the end of the step, order 1
///     midpoint   β' = β = 1/4,    σ' = θ, σ = 1 - θ   for u, u' at t_n -+ h/2, order 2
///
/// The midpoint rule is the average acceleration method (Newmark 1959, β = 1/4) for the spring, and conserves the energy
/// of a linear oscillator. Its damper is fitted to the exponential: with the inverse effective mass W = C M⁻¹ Cᵀ
/// of the bodies without constraints and x = h c W,
///
///     θ(x) = 1/(1 - exp(-x)) - 1/x = 1/2 + x/12 - ...
///
/// A damper alone then has the exact ratio u'/u = exp(-x) for free bodies: no oscillation at any step size.
///
/// Both rules are stable for every step size: the oscillator M S̈ + c Ṡ + k S = 0 has roots within the unit circle
/// for all k ≥ 0, c ≥ 0. The correction is of first order in h for Euler and of second order for midpoint, whatever k
/// and c are, so the scheme keeps its order for loads that depend on S and Ṡ in another way. Derivatives k < 0 or
/// c < 0 are replaced by zero. The change of direction of C within the step is not part of the correction.
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
    ///     (M + Σ (h² k/4) Cᵀ C) v = M v_0,    (M + Σ h d Cᵀ C) v̇ = M v̇_0
    ///
    /// with the constraint rows Φ_r ṙ + Π̄ ω̄ and Φ_r r̈ + Π̄ ω̄̇ unchanged. v is the mean of the velocities half a step
    /// before and after the start. They differ from v_0 and v̇_0 by O(h²) and O(h). Without the change a motion along
    /// a spring that is too fast for the step would have the energy of the mass M + (h² k/4) Cᵀ C.
    ///
    /// Allocates memory. start() has been called for x.
    void smooth_start(State& x) const;
    /// The inverse for the velocities of a node: replaces the means v by v_0. The steps before and after the node
    /// have the length `step`.
    void restore_velocities(State& node, double step) const;
    /// Writes -h λ_0/d of each row. `before` holds h u and `node` h v_n, six components per body.
    void set_right_side(const Eigen::VectorXd& before, const Eigen::VectorXd& node,
                        Eigen::Ref<Eigen::VectorXd> out) const;

private:
    const System& system;
    const Rule rule;
    Springs springs;
    std::vector<double> compliances, theta;
    double h = 0;

    struct AtNode;
    std::unique_ptr<AtNode> at_node;  ///< workspace of restore_velocities()
};

}  // namespace hilda::lie
