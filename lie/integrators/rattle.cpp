// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle: RATTLE (Andersen 1983) on the Lie group, RATTLie.                      Hante, Arnold (2021)
///
///     ½-step    M ṙ_{n+½} + ½h Φ_rᵀ λ⁺ = M ṙ_n + ½h F_n
///               J_r(θ)⁻¹ J̄ ω̄_{n+½} + ½h Π̄ᵀ λ⁺ = J̄ ω̄_n + ½h n̄_n,     θ = h ω̄_{n+½}
///     node      r_{n+1} = r_n + h ṙ_{n+½},   A_{n+1} = A_n exp(θ̃),   Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///     ½-step    M ṙ_{n+1} + ½h Φ_rᵀ λ⁻ = M ṙ_{n+½} + ½h F_{n+1}
///               J̄ ω̄_{n+1} + ½h Π̄ᵀ λ⁻ = J_r(θ)⁻ᵀ J̄ ω̄_{n+½} + ½h n̄_{n+1},   Φ_r ṙ_{n+1} + Π̄ ω̄_{n+1} = ν
///
/// Source: Hante, Arnold (2021), J. Comput. Appl. Math. 387, 112492. Φ_r, Π̄ are those of t_n in the first
/// half and of t_{n+1} in the second. The discrete Lagrangian is h T(log(A_nᵀ A_{n+1})/h). Its two Legendre
/// transforms J_r(θ)⁻¹ J̄ ω̄_{n+½} and J_r(θ)⁻ᵀ J̄ ω̄_{n+½} contain the gyroscopic torque. For loads with a
/// potential the step is symplectic and conserves momentum exactly. Loads that depend on velocities use ṙ_n,
/// ω̄_n in the first half and 2 ṙ_{n+½} - ṙ_n, 2 ω̄_{n+½} - ω̄_n in the second.
///
/// r, A, ṙ, ω̄ and λ are of order 2. The multipliers reported are not λ⁺ and λ⁻: accelerations and
/// multipliers are computed from the saddle system at the node.
///
/// The unknowns are z = (r_{n+1} - r_n, θ, ½h² λ⁺) with the Newton matrix K(t_n), where J_r(θ)⁻¹ J̄ θ - J̄ θ
/// is part of the residual. Velocities and accelerations take one solve each with K(t_{n+1}), which is the
/// Newton matrix of the next step.

#include "lie/schemes.hpp"
#include "lie/steps/node_step.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class Rattle final : public NodeStep {
public:
    using NodeStep::NodeStep;

    Statistics statistics() const override
    {
        Statistics s = NodeStep::statistics();
        s.refactorizations -= repeated;
        return s;
    }

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        assemble_at_start();
        set_known_part(h);
        predict(h, 0.5 * h * h, 0.5 * h * h);  // constant accelerations, and the multipliers of t_n
        x.t = x_n.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x);
            set_linear_residual(K.rows());
            balance_momentum();
            set_constraint_residual(1, x, 1);
            K.solve(e);
            z += e;
            if (converged(k, length_of_motion(e), K.constraint_part(e), 1)) {
                place(x);
                for (Motion& body : x.body) body.A = orthonormalised(body.A);
                set_velocities(x, h);
                set_accelerations(x);
                return done(attempt, k);
            }
        }
        no_convergence("rA-rattle", correction, x);
    }

private:
    /// Assembles K(t_n). The step before has assembled it already, except before the first step of a run,
    /// where its time differs by rounding, and for contacts, whose tangent vectors have changed when the node
    /// was accepted. Not counted, so that a resumed run has the counts of an uninterrupted one.
    void assemble_at_start()
    {
        const long before = NodeStep::statistics().refactorizations;
        if (model.pattern().algebraic_variables() > 0)
            K.assemble(x_n);
        else
            assemble_once(x_n);
        repeated += NodeStep::statistics().refactorizations - before;
    }

    /// h M ṙ_n + ½h² F_n and h J̄ ω̄_n + ½h² n̄_n
    void set_known_part(double h)
    {
        model.loads(x_n, loads);
        for (int i = 0; i < bodies; ++i) {
            const Motion& body = x_n.body[i];
            b.segment<3>(6 * i) = h * mass.m[i] * body.rdot + 0.5 * h * h * loads.F[i];
            b.segment<3>(6 * i + 3) = h * (mass.J_bar[i] * body.omega_bar) + 0.5 * h * h * loads.n_bar[i];
        }
        K.constraint_part(b).setZero();
        K.algebraic_part(b).setZero();
    }

    /// The pose x at t_{n+1} from z
    void place(State& x)
    {
        place_increments(x);
        place_algebraic(x, 1);
    }

    /// The second half step: ṙ, ω̄ at t_{n+1}
    void set_velocities(State& x, double h)
    {
        for (int i = 0; i < bodies; ++i) {
            x.body[i].rdot = 2 / h * z.segment<3>(6 * i) - x_n.body[i].rdot;
            x.body[i].omega_bar = 2 / h * z.segment<3>(6 * i + 3) - x_n.body[i].omega_bar;
        }
        model.loads(x, loads);
        for (int i = 0; i < bodies; ++i) {
            e.segment<3>(6 * i) = mass.m[i] / h * z.segment<3>(6 * i) + 0.5 * h * loads.F[i];
            e.segment<3>(6 * i + 3) = -momentum(i, -z.segment<3>(6 * i + 3)) / h + 0.5 * h * loads.n_bar[i];
        }
        assemble_once(x);
        solve_velocities(model, K, x, e);
    }

    long repeated = 0;  ///< refactorisations at the beginning of a step
};

const bool registered =
    register_scheme<Rattle>({.name = "rA-rattle",
                             .description = "RATTLE on the Lie group (RATTLie), variational",
                             .order = 2,
                             .order_lambda = 2,
                             .formulation = "rA",
                             .unknowns = "r, h omega, h^2 lambda / 2",
                             .source = "Hante, Arnold (2021)",
                             .algebraic = true});

}  // namespace
}  // namespace hilda::lie
