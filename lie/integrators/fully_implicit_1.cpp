// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-full-1: backward Euler on the Lie group, index 3.                            Fang (2022), Sec. 3.4
///
///     M r̈ + Φ_rᵀ λ = F,   J̄ ω̄̇ + Π̄ᵀ λ = τ̄,   Φ / h² = 0       all at t_{n+1}                          (3.16)
///     ṙ = ṙ_n + h r̈,   r = r_n + h ṙ,   ω̄ = ω̄_n + h ω̄̇,   A = A_n exp(h ω̄)                            (3.19)
///
/// The unknowns are z = (r̈, ω̄̇, λ) at t_{n+1}; see BackwardEulerStep.
///
/// The Newton matrix is (3.23) without the sensitivities of the loads: K at t_n, frozen. The neglected terms
/// cost iterations, not accuracy. The iteration diverges if a load has a stiffness of about m/h² or a damping
/// of about m/h, or more.
///
/// r, A, ṙ, ω̄ and λ are of order 1. Exception: if the system moves at the start, the multipliers of the
/// first computed node contain half of the centripetal term only, and have an error of O(1). From the second
/// node on their error is O(h).

#include "lie/schemes.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/backward_euler_step.hpp"

namespace hilda::lie {
namespace {

class FullyImplicit1 final : public BackwardEulerStep {
public:
    FullyImplicit1(const System& model, const Settings& settings)
        : BackwardEulerStep(model, settings, "rA-full-1"), K(model, Metric::mass, settings.linear_solver)
    {}

    Statistics statistics() const override { return statistics_with(K); }
    const State* pivots() const override { return &K.pivots(); }
    void choose_pivots(const State& x, double /*h*/) override { K.choose_pivots(x); }

private:
    void begin(double h) override
    {
        K.set_shift(shift(h));
        K.assemble(x_n);
    }
    void solve(const State& /*x*/, double /*h*/) override { K.solve(e); }

    Saddle K;  ///< the Newton matrix, frozen at t_n (Eq. 3.23)
};

const bool registered_fully_implicit_1 = register_scheme<FullyImplicit1>(
    {.name = "rA-full-1",
     .description = "backward Euler on SO(3), index 3, with a frozen Newton matrix",
     .order = 1,
     .order_lambda = 1,
     .formulation = "rA",
     .unknowns = "r'', omega', lambda",
     .uses = newton_options,
     .source = "Fang (2022), Sec. 3.4",
     .loads = LoadEvaluation::extrapolated,
     .supports = {Feature::algebraic, Feature::redundant, Feature::history}});

}  // namespace
}  // namespace hilda::lie
