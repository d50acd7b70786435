// SPDX-License-Identifier: GPL-3.0-or-later
/// The half-implicit scheme of second order with BDF2 for the positions: second order in the multipliers too.
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n             Fang (2022), 3.39, 3.40
///     ṙ_{n+1} = ṙ_n + h (3 r̈_n - r̈_{n-1}) / 2,   ω̄_{n+1} = ω̄_n + h (3 ω̄̇_n - ω̄̇_{n-1}) / 2         3.35, 3.37
///     r_{n+1} = r_n + (r_n - r_{n-1}) / 3 + ⅔ h ṙ_{n+1}                                       for 3.36
///     A_{n+1} = A_n exp(ψ_{n+1}),   ψ_{n+1} = ψ_n / 3 + ⅔ h ω̄_{n+1}                           for 3.38
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// The trapezoid rule of (3.36, 3.38) never damps the residual of the velocity constraints (root -1), and λ
/// carries an alternating error of O(h). BDF2 damps it by a third in each step. The two rules share the factor
/// 3E - 1, so that translation is Störmer-Verlet but for transients (1/3)ⁿ: no oscillation grows.
///
/// With the unknowns z = (h ṙ_{n+1}, θ̄ = h ω̄_{n+1}, 1.5 h² λ_n) and the constraint rows times 1.5, the Newton
/// matrix is K. Start: r̈_{-1} = r̈_0, r_0 - r_{-1} = h ṙ_0 - ½h² r̈_0, ψ_0 = h ω̄_0 - ½h² ω̄̇_0. The state carries
/// r_n - r_{n-1} and ψ_n of each body.

#include "lie/newton_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit2Bdf2 final : public SaddleStep {
public:
    using SaddleStep::SaddleStep;

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        if (x_n.history.size() == 0)
            start(h);
        else
            increments = x_n.history;
        K.assemble(x_n);  // the Newton matrix, frozen at t_n
        set_known_part(h);
        predict(h);
        x.t = x_n.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x);
            correct(k, x, 1.5);
            if (converged(k, length_of_motion(), K.constraint_part(e), 1 / 1.5)) {
                accept(x, h);
                return done(attempt, k);
            }
        }
        no_convergence("rA-half-2-bdf2", correction, x);
    }

    bool lags() const override { return true; }
    void complete(State& node, const State& after) const override { take_loads(node, after); }

private:
    void start(double h)
    {
        increments.resize(6 * model.bodies());
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            increments.segment<6>(6 * i) << h * body.rdot - 0.5 * h * h * body.rddot,
                h * body.omega_bar - 0.5 * h * h * body.omegadot_bar;
        }
    }

    /// M (h ṙ_n - ½h² r̈_{n-1}) + 1.5h² F_n, likewise for the rotations
    void set_known_part(double h)
    {
        model.loads(x_n, loads);
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            b.segment<3>(6 * i) =
                h * model.mass().m[i] * (body.rdot - 0.5 * h * body.rddot) + 1.5 * h * h * loads.F[i];
            b.segment<3>(6 * i + 3) =
                h * (model.mass().J_bar[i] * (body.omega_bar - 0.5 * h * body.omegadot_bar)) +
                1.5 * h * h * tau_bar(i, body);
        }
        K.constraint_part(b).setZero();
    }

    void predict(double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            z.segment<3>(6 * i) = h * body.rdot + h * h * body.rddot;
            z.segment<3>(6 * i + 3) = h * body.omega_bar + h * h * body.omegadot_bar;
        }
        K.constraint_part(z) = 1.5 * h * h * x_n.lambda;
    }

    /// r_{n+1} - r_n and ψ_{n+1} of body i
    Eigen::Matrix<double, 6, 1> advance(int i) const
    {
        return increments.segment<6>(6 * i) / 3 + z.segment<6>(6 * i) * (2.0 / 3);
    }

    void place(State& x) const
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Eigen::Matrix<double, 6, 1> d = advance(i);
            x.body[i].r = x_n.body[i].r + d.head<3>();
            x.body[i].A = x_n.body[i].A * exp(d.tail<3>());
        }
    }

    /// Length of the correction in r and θ̄, as for rA-half-2
    double length_of_motion() const
    {
        double sum = 0;
        for (int i = 0; i < model.bodies(); ++i)
            sum += e.segment<3>(6 * i).squaredNorm() / 2.25 + e.segment<3>(6 * i + 3).squaredNorm();
        return std::sqrt(sum);
    }

    void accept(State& x, double h)
    {
        place(x);
        x.lambda = K.constraint_part(z) / (1.5 * h * h);
        b.setZero();
        K.rows().add_transpose(1, x.lambda, b);
        for (int i = 0; i < model.bodies(); ++i) {
            increments.segment<6>(6 * i) = advance(i);
            Motion& body = x.body[i];
            body.A = orthonormalised(body.A);
            body.rdot = z.segment<3>(6 * i) / h;
            body.omega_bar = z.segment<3>(6 * i + 3) / h;
            body.rddot = (loads.F[i] - b.segment<3>(6 * i)) / model.mass().m[i];
            body.omegadot_bar = J_bar_inverse[i] * (tau_bar(i, x_n.body[i]) - b.segment<3>(6 * i + 3));
        }
        x.history = increments;
    }

    Eigen::VectorXd increments;  ///< r_n - r_{n-1} and ψ_n of each body
};

const bool enrolled = enrol<HalfImplicit2Bdf2>({.name = "rA-half-2-bdf2",
                                                .order = 2,
                                                .order_lambda = 2,
                                                .formulation = "rA",
                                                .unknowns = "r, h omega, h^2 lambda",
                                                .source = "Fang (2022), Sec. 3.6, with BDF2 for positions"});

}  // namespace
}  // namespace hilda::lie
