// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-full-1: backward Euler on the Lie group, index 3.                            Fang (2022), Sec. 3.4
///
///     M r̈ + Φ_rᵀ λ = F,   J̄ ω̄̇ + Π̄ᵀ λ = τ̄,   Φ / h² = 0       all at t_{n+1}                          (3.16)
///     ṙ = ṙ_n + h r̈,   r = r_n + h ṙ,   ω̄ = ω̄_n + h ω̄̇,   A = A_n exp(h ω̄)                            (3.19)
///
/// With algebraic variables, Φ_αᵀ λ = 0 at t_{n+1} in addition. The unknowns are z = (r̈, ω̄̇, λ) at t_{n+1}.
///
/// The Newton matrix is (3.23) without the sensitivities of the loads: K at t_n, frozen. The neglected terms
/// cost iterations, not accuracy. The iteration diverges if a load has a stiffness of about m/h² or a damping
/// of about m/h, or more.
///
/// r, A, ṙ, ω̄ and λ are of order 1. Exception: if the system moves at the start, the multipliers of the first
/// computed node contain half of the centripetal term only, and have an error of O(1). From the second node
/// on their error is O(h).

#include "lie/schemes.hpp"
#include "lie/steps/saddle_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class FullyImplicit1 final : public SaddleStep {
public:
    FullyImplicit1(const System& model, const Settings& settings)
        : SaddleStep(model, settings), C(model.pattern())
    {}

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        K.assemble(x_n);  // the Newton matrix, frozen at t_n (Eq. 3.23)
        predict();
        x.t = x_n.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x, h);
            set_residual(x, h);
            K.solve(e);
            z -= e;
            if (converged(k, h * h * length_of_motion(e), K.constraint_part(e), h * h)) {
                place(x, h);
                refuse_whole_turns(x, h, "rA-full-1");
                for (Motion& body : x.body) body.A = orthonormalised(body.A);
                return done(attempt, k);
            }
        }
        no_convergence("rA-full-1", correction, x);
    }

private:
    /// Initial guess: accelerations and multipliers of t_n
    void predict()
    {
        for (int i = 0; i < model.bodies(); ++i) {
            z.segment<3>(6 * i) = x_n.body[i].rddot;
            z.segment<3>(6 * i + 3) = x_n.body[i].omegadot_bar;
        }
        K.constraint_part(z) = x_n.lambda;
        K.algebraic_part(z).setZero();
    }

    /// The state x at t_{n+1} from z (Eq. 3.19)
    void place(State& x, double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& from = x_n.body[i];
            Motion& body = x.body[i];
            body.rddot = z.segment<3>(6 * i);
            body.omegadot_bar = z.segment<3>(6 * i + 3);
            body.rdot = from.rdot + h * body.rddot;
            body.omega_bar = from.omega_bar + h * body.omegadot_bar;
            body.r = from.r + h * body.rdot;
            body.A = from.A * exp(h * body.omega_bar);
        }
        place_algebraic(x, h * h);
        x.lambda = K.constraint_part(z);
    }

    /// The residual e in the state x (Eq. 3.20)
    void set_residual(const State& x, double h)
    {
        model.loads(x, loads);
        model.variation(x, C);
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x.body[i];
            e.segment<3>(6 * i) = model.mass().m[i] * body.rddot - loads.F[i];
            e.segment<3>(6 * i + 3) = model.mass().J_bar[i] * body.omegadot_bar - tau_bar(i, body);
        }
        C.add_transpose(1, x.lambda, e);
        K.algebraic_part(e).setZero();
        C.add_algebraic_transpose(1, x.lambda, K.algebraic_part(e));
        model.phi(x, K.constraint_part(e));
        K.constraint_part(e) /= h * h;
    }

    Rows C;  ///< Φ_r, Π̄ at the iterate
};

const bool registered = register_scheme<FullyImplicit1>(
    {.name = "rA-full-1",
     .description = "backward Euler on SO(3), index 3, with a frozen Newton matrix",
     .order = 1,
     .order_lambda = 1,
     .formulation = "rA",
     .unknowns = "r'', omega', lambda",
     .source = "Fang (2022), Sec. 3.4",
     .algebraic = true});

}  // namespace
}  // namespace hilda::lie
