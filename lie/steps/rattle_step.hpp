// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the schemes that consist of steps of RATTLE on the Lie group (RATTLie).
///
///     ½-step    M ṙ_{n+½} + ½h Φ_rᵀ λ⁺ = M ṙ_n + ½h F_n                                Hante, Arnold (2021)
///               J_r(θ)⁻¹ J̄ ω̄_{n+½} + ½h Π̄ᵀ λ⁺ = J̄ ω̄_n + ½h n̄_n,     θ = h ω̄_{n+½}
///     node      r_{n+1} = r_n + h ṙ_{n+½},   A_{n+1} = A_n exp(θ̃),   Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///     ½-step    M ṙ_{n+1} + ½h Φ_rᵀ λ⁻ = M ṙ_{n+½} + ½h F_{n+1}
///               J̄ ω̄_{n+1} + ½h Π̄ᵀ λ⁻ = J_r(θ)⁻ᵀ J̄ ω̄_{n+½} + ½h n̄_{n+1},   Φ_r ṙ_{n+1} + Π̄ ω̄_{n+1} = ν
///
/// Φ_r, Π̄ are those of t_n in the first half and of t_{n+1} in the second. The discrete Lagrangian is h
/// T(log(A_nᵀ A_{n+1})/h). Its two Legendre transforms J_r(θ)⁻¹ J̄ ω̄_{n+½} and J_r(θ)⁻ᵀ J̄ ω̄_{n+½}
/// contain the gyroscopic torque. For loads with a potential the step is symplectic and conserves momentum
/// exactly.
///
/// The second half is the adjoint of the first, so that the step is symmetric: a step of -h returns to the
/// start. Its loads are those of the velocities ṙ_{n+1}, ω̄_{n+1} that they determine. These are found by a
/// fixed-point iteration with Anderson's acceleration, from 2 ṙ_{n+½} - ṙ_n, 2 ω̄_{n+½} - ω̄_n. A symmetric
/// step has an error with even powers of h only, which compositions and extrapolation use. Loads with a
/// history (friction) change with each evaluation of the state; they take the starting value of the
/// iteration, and the step is of order 2 without being symmetric.
///
/// The unknowns are z = (r_{n+1} - r_n, θ, ½h² λ⁺) with the Newton matrix K(t_n), where J_r(θ)⁻¹ J̄ θ - J̄ θ
/// is part of the residual. Velocities and accelerations take one solve each with K(t_{n+1}), which is the
/// Newton matrix of the next step. The multipliers of the node are those of its saddle system.

#pragma once

#include "lie/steps/anderson.hpp"
#include "lie/steps/node_step.hpp"

#include <string>

namespace hilda::lie {

class RattleStep : public NodeStep {
public:
    /// `name`: of the scheme, for messages
    RattleStep(const System& model, const Settings& settings, std::string name);

    Statistics statistics() const override;

protected:
    /// Advances x from x_n, which it is equal to, by a step h, which may be negative, to the time t_end.
    /// Returns the number of Newton iterations. If NumericalFailure is thrown, x is undefined.
    int advance(State& x, double h, double t_end);

    const std::string name;

private:
    void assemble_at_start();
    void set_known_part(double h);
    void place(State& x);
    void set_velocities(State& x, double h);
    bool settled(double change, double before) const;

    Loads loads_before;                  ///< of the iteration of the loads
    Eigen::VectorXd v, dv;               ///< its iterate, the velocities of all bodies, and the correction
    static constexpr int patience = 10;  ///< corrections before they are accelerated
    Anderson anderson;
    Anderson of_loads;
    const bool accelerates;  ///< not with algebraic variables: their scale differs from that of the bodies
    const bool varies;       ///< whether the loads depend on the state
    long repeated = 0;       ///< refactorisations at the beginning of a step
};

}  // namespace hilda::lie
