// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-half-2: Adams-Bashforth 2 for velocities, trapezoidal rule for positions.      Fang (2022), Sec. 3.6
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                      (3.39, 3.40)
///     ṙ_{n+1} = ṙ_n + h (3 r̈_n - r̈_{n-1}) / 2,   r_{n+1} = r_n + h (ṙ_n + ṙ_{n+1}) / 2        (3.35, 3.36)
///     ω̄_{n+1} = ω̄_n + h (3 ω̄̇_n - ω̄̇_{n-1}) / 2                                                (3.37)
///     A_{n+1} = A_n exp(h ω̄_n / 2) exp(h ω̄_{n+1} / 2)                                        (3.38)
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0                                                       (3.41)
///
/// Start: r̈_{-1} = r̈_0, ω̄̇_{-1} = ω̄̇_0 from the consistent start.
///
/// The unknowns are z = (h ṙ_{n+1}, θ̄ = h ω̄_{n+1}, 1.5 h² λ_n). With the constraint rows doubled, the
/// Newton matrix (3.51) is K(t_n).
///
/// r, A, ṙ, ω̄ are of order 2, λ of order 1. The residual of the velocity constraints, g = C v - ν, satisfies
/// g_{n+1} + g_n = O(h²). The recursion has the parasitic root -1, which is not damped. The multipliers have
/// an alternating error of O(h), unless the system starts at rest. rA-half-2-bdf2 is free of it. A jump of a
/// prescribed velocity is a new start.

#include "lie/schemes.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/half_implicit_step.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit2 final : public HalfImplicitStep {
public:
    HalfImplicit2(const System& model, const Settings& settings)
        : HalfImplicitStep(model, settings, "rA-half-2", 1.5, 2), A_hat(bodies)
    {}

private:
    /// Â = A_n exp(½h ω̄_n) (Eq. 3.44)
    void begin(double h) override
    {
        half_h = 0.5 * h;
        restart_after_impulse(h);
        for (int i = 0; i < bodies; ++i) A_hat[i] = x_n.body[i].A * exp(half_h * x_n.body[i].omega_bar);
    }

    void place(State& x) const override
    {
        for (int i = 0; i < bodies; ++i) {
            x.body[i].r = x_n.body[i].r + half_h * x_n.body[i].rdot + 0.5 * z.segment<3>(6 * i);
            x.body[i].A = A_hat[i] * exp(0.5 * z.segment<3>(6 * i + 3));  // Eq. 3.45
        }
    }

    /// Starts again at x_n if prescribed velocities have jumped since the node before: the velocities receive
    /// the impulse that the constraints require, and the accelerations before it are forgotten. The
    /// velocity constraints would otherwise alternate for ever.
    void restart_after_impulse(double h)
    {
        const double after = 2 * break_distance(x_n.t);
        if (!model.velocity_jumps(x_n.t - h + after, x_n.t + after)) return;
        const double t = x_n.t;
        K.set_shift(shift(h));
        K.assemble(x_n);
        x_n.t += after;  // behind a jump at the node
        set_momenta(model, x_n, e);
        solve_velocities(model, K, x_n, e);
        solve_accelerations(model, K, x_n, loads, e);
        x_n.t = t;
    }

    std::vector<Mat3> A_hat;  ///< A_n exp(½h ω̄_n)
    double half_h = 0;
};

const bool registered_half_implicit_2 = register_scheme<HalfImplicit2>(
    {.name = "rA-half-2",
     .description = "Adams-Bashforth 2 for velocities, trapezoidal rule for positions",
     .order = 2,
     .order_lambda = 1,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .uses = newton_options,
     .source = "Fang (2022), Sec. 3.6",
     .loads = LoadEvaluation::extrapolated,
     .supports = {Feature::algebraic, Feature::redundant, Feature::history},
     .energy_drifts = true});

}  // namespace
}  // namespace hilda::lie
