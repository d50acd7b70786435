// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-half-2-bdf2: Adams-Bashforth 2 for velocities, BDF2 for positions.
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n             Fang (2022), 3.39, 3.40
///     ṙ_{n+1} = ṙ_n + h (3 r̈_n - r̈_{n-1}) / 2,   ω̄_{n+1} = ω̄_n + h (3 ω̄̇_n - ω̄̇_{n-1}) / 2         3.35, 3.37
///     r_{n+1} = r_n + (r_n - r_{n-1}) / 3 + ⅔ h ṙ_{n+1}                                       for 3.36
///     A_{n+1} = A_n exp(ψ_{n+1}),   ψ_{n+1} = ψ_n / 3 + ⅔ h ω̄_{n+1}                           for 3.38
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// Start: v̇_{-1} = v̇_0, r_0 - r_{-1} = h ṙ_0 - ½h² r̈_0, ψ_0 = h ω̄_0 - ½h² ω̄̇_0, with v = (ṙ, ω̄).
///
/// r, A, ṙ, ω̄ and λ are of order 2. With BDF2 the residual of the velocity constraints has no recursion with
/// the root -1, as it has with the trapezoidal rule of (3.36, 3.38) in rA-half-2.
///
/// With d_n = (r_n - r_{n-1}, ψ_n), both rules together read e_n = e_{n-1}/3 for e_n = d_{n+1} - d_n - h²
/// v̇_n. The start gives e_0 = 0, hence d_{n+1} = d_n + h² v̇_n for all n. This is leapfrog with the
/// half-step velocities d_n/h. The scheme therefore computes the same r, A and λ as rA-half-1-kick. Only the
/// reported velocities differ. They are extrapolated to the node here, v_{n+1} = (3 d_{n+1} - d_n)/(2h).
/// rA-half-1-kick reports the mean of the half-step velocities, which is more accurate.
///
/// The unknowns are z = (h ṙ_{n+1}, h ω̄_{n+1}, 1.5 h² λ_n). With the constraint rows times 1.5 the Newton
/// matrix is K(t_n). State::history holds r_n - r_{n-1} and ψ_n of each body.

#include "lie/schemes.hpp"
#include "lie/steps/half_implicit_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit2Bdf2 final : public HalfImplicitStep {
public:
    HalfImplicit2Bdf2(const System& model, const Settings& settings)
        : HalfImplicitStep(model, settings, "rA-half-2-bdf2", 1.5, 1.5)
    {}

    bool keeps_history() const override { return true; }

private:
    void begin(double h) override
    {
        if (x_n.history.size() > 0) {
            increments = x_n.history;
            return;
        }
        increments.resize(6 * bodies);
        for (int i = 0; i < bodies; ++i) {
            const Motion& body = x_n.body[i];
            increments.segment<6>(6 * i) << h * body.rdot - 0.5 * h * h * body.rddot,
                h * body.omega_bar - 0.5 * h * h * body.omegadot_bar;
        }
    }

    /// r_{n+1} - r_n and ψ_{n+1} of body i
    Vec6 advance(int i) const { return increments.segment<6>(6 * i) / 3 + z.segment<6>(6 * i) * (2.0 / 3); }

    void place(State& x) const override
    {
        for (int i = 0; i < bodies; ++i) {
            const Vec6 d = advance(i);
            x.body[i].r = x_n.body[i].r + d.head<3>();
            x.body[i].A = x_n.body[i].A * exp(d.tail<3>());
        }
    }

    void leave(State& x, double h) override
    {
        HalfImplicitStep::leave(x, h);
        for (int i = 0; i < bodies; ++i) increments.segment<6>(6 * i) = advance(i);
        x.history = increments;
    }

    Eigen::VectorXd increments;  ///< r_n - r_{n-1} and ψ_n of each body
};

const bool registered_half_implicit_2_bdf2 = register_scheme<HalfImplicit2Bdf2>(
    {.name = "rA-half-2-bdf2",
     .description = "Adams-Bashforth 2 for velocities, BDF2 for positions",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .uses = newton_options,
     .source = "Fang (2022), Sec. 3.6, with BDF2 for positions",
     .loads = LoadEvaluation::extrapolated,
     .supports = {Feature::algebraic, Feature::redundant, Feature::history},
     .energy_drifts = true});

}  // namespace
}  // namespace hilda::lie
