// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the backward Euler schemes on the Lie group, index 3.              Fang (2022), Sec. 3.4
///
///     M r̈ + Φ_rᵀ λ = F,   J̄ ω̄̇ + Π̄ᵀ λ = τ̄,   Φ / h² = 0       all at t_{n+1}                          (3.16)
///     ṙ = ṙ_n + h r̈,   r = r_n + h ṙ,   ω̄ = ω̄_n + h ω̄̇,   A = A_n exp(h ω̄)                            (3.19)
///
/// With algebraic variables, Φ_αᵀ λ = 0 at t_{n+1} in addition. The unknowns are z = (r̈, ω̄̇, λ) at t_{n+1}.

#pragma once

#include "lie/solver/saddle.hpp"
#include "lie/steps/newton_step.hpp"

#include <memory>

namespace hilda::lie {

/// A derived class provides the Newton matrix.
class BackwardEulerStep : public NewtonStep {
public:
    int step(State& x, double h) final;

protected:
    BackwardEulerStep(const System& model, const Settings& settings, std::string name);

    /// Called at the beginning of a step h from x_n
    virtual void begin(double /*h*/) {}
    /// e ← N⁻¹ e, with the Newton matrix N of the iterate x
    virtual void solve(const State& x, double h) = 0;

    Rows C;  ///< Φ_r, Π̄ at the iterate

private:
    void place(State& x, double h) const;
    void set_residual(const State& x, double h);

    const std::string name;
    std::unique_ptr<Saddle> of_multipliers;  ///< with redundant rows: for the multipliers of minimum norm
};

}  // namespace hilda::lie
