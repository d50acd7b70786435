// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit Lie-group scheme of first order.                                   Fang (2022), Sec. 3.5
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                              (3.24)
///     ṙ_{n+1} = ṙ_n + h r̈_n,    r_{n+1} = r_n + h ṙ_{n+1}                                            (3.25)
///     ω̄_{n+1} = ω̄_n + h ω̄̇_n,    A_{n+1} = A_n exp(h ω̄_{n+1})
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// The unknowns are z = (r_{n+1} - r_n, θ̄ = h ω̄_{n+1}, λ̂ = h² λ_n): the increment instead of the r_{n+1} of
/// (3.27), which changes no iterate but keeps the digits that M r_{n+1} - M r_n would lose.
///
/// ṙ_{n+1} and ω̄_{n+1} are reported as the scheme stores them. They are the velocities at t_n + h/2 rather than
/// at t_{n+1}, which is its first-order error; converting them would hide what the orders are measured for.

#include "lie/newton_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1 final : public SaddleStep {
public:
    using SaddleStep::SaddleStep;

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        K.assemble(x_n);  // the Newton matrix, frozen at t_n (Eq. 3.32)
        set_known_part(h);
        predict(h);
        x.t = x_n.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x);
            correct(k, x, 1);
            if (converged(k, motion_part(e).norm(), K.constraint_part(e), 1)) {
                accept(x, h);
                return done(attempt, k);
            }
        }
        no_convergence("rA-half-1", correction, x);
    }

    bool lags() const override { return true; }
    void complete(State& node, const State& after) const override { take_loads(node, after); }

private:
    /// h M ṙ_n + h² F_n and h J̄ ω̄_n + h² τ̄_n: the -b_n and -c_n of Eq. 3.29, without M r_n
    void set_known_part(double h)
    {
        model.loads(x_n, loads);
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            b.segment<3>(6 * i) = h * model.mass().m[i] * body.rdot + h * h * loads.F[i];
            b.segment<3>(6 * i + 3) = h * (model.mass().J_bar[i] * body.omega_bar) + h * h * tau_bar(i, body);
        }
        K.constraint_part(b).setZero();
    }

    /// Guess with the accelerations and multipliers of the step before                               Eq. 3.34
    void predict(double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            z.segment<3>(6 * i) = h * body.rdot + h * h * body.rddot;
            z.segment<3>(6 * i + 3) = h * body.omega_bar + h * h * body.omegadot_bar;
        }
        K.constraint_part(z) = h * h * x_n.lambda;
    }

    void place(State& x) const
    {
        for (int i = 0; i < model.bodies(); ++i) {
            x.body[i].r = x_n.body[i].r + z.segment<3>(6 * i);
            x.body[i].A = x_n.body[i].A * exp(z.segment<3>(6 * i + 3));
        }
    }

    void accept(State& x, double h)
    {
        place(x);
        x.lambda = K.constraint_part(z) / (h * h);
        b.setZero();
        K.rows().add_transpose(1, x.lambda, b);
        for (int i = 0; i < model.bodies(); ++i) {
            Motion& body = x.body[i];
            body.A = orthonormalised(body.A);
            body.rdot = z.segment<3>(6 * i) / h;
            body.omega_bar = z.segment<3>(6 * i + 3) / h;
            body.rddot = (loads.F[i] - b.segment<3>(6 * i)) / model.mass().m[i];  // Eq. 3.24
            body.omegadot_bar = J_bar_inverse[i] * (tau_bar(i, x_n.body[i]) - b.segment<3>(6 * i + 3));
        }
    }
};

const bool enrolled = enrol<HalfImplicit1>({.name = "rA-half-1",
                                            .order = 1,
                                            .order_lambda = 1,
                                            .formulation = "rA",
                                            .unknowns = "r, h omega, h^2 lambda",
                                            .source = "Fang (2022), Sec. 3.5"});

}  // namespace
}  // namespace hilda::lie
