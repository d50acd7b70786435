// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit Lie-group scheme of second order.                                  Fang (2022), Sec. 3.6
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                      (3.39, 3.40)
///     ṙ_{n+1} = ṙ_n + h (3 r̈_n - r̈_{n-1}) / 2,   r_{n+1} = r_n + h (ṙ_n + ṙ_{n+1}) / 2        (3.35, 3.36)
///     ω̄_{n+1} = ω̄_n + h (3 ω̄̇_n - ω̄̇_{n-1}) / 2                                                (3.37)
///     A_{n+1} = A_n exp(h ω̄_n / 2) exp(h ω̄_{n+1} / 2)                                        (3.38)
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0                                                       (3.41)
///
/// With the unknowns z = (h ṙ_{n+1}, θ̄ = h ω̄_{n+1}, 1.5 h² λ_n) and the constraint rows doubled, the Newton
/// matrix 3.51 is K itself. r̈_{-1} = r̈_0, ω̄̇_{-1} = ω̄̇_0 from the consistent start. The multipliers carry an
/// alternating error of O(h) unless the start is at rest: the trapezoid rule never damps the velocity
/// residual's parasitic root -1.

#include "lie/newton_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit2 final : public SaddleStep {
public:
    HalfImplicit2(const System& model, const Settings& settings)
        : SaddleStep(model, settings), A_hat(model.bodies())
    {}

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        K.assemble(x_n);  // the Newton matrix, frozen at t_n (Eq. 3.51)
        set_known_part(h);
        predict(h);
        x.t = x_n.t + h;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x);
            correct(k, x, 2);
            if (converged(k, length_of_motion(), K.constraint_part(e), 1 / 1.5)) {
                accept(x, h);
                return done(attempt, k);
            }
        }
        no_convergence("rA-half-2", correction, x);
    }

    bool lags() const override { return true; }
    void complete(State& node, const State& after) const override { take_loads(node, after); }

private:
    /// M (h ṙ_n - ½h² r̈_{n-1}) + 1.5h² F_n, likewise for the rotations; and Â of Eq. 3.44
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
            A_hat[i] = body.A * exp(0.5 * h * body.omega_bar);
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
        half_h = 0.5 * h;
    }

    void place(State& x) const
    {
        for (int i = 0; i < model.bodies(); ++i) {
            x.body[i].r = x_n.body[i].r + half_h * x_n.body[i].rdot + 0.5 * z.segment<3>(6 * i);
            x.body[i].A = A_hat[i] * exp(0.5 * z.segment<3>(6 * i + 3));  // Eq. 3.45
        }
    }

    /// Length of the correction in r and θ̄, the unknowns of Eq. 3.43
    double length_of_motion() const
    {
        double sum = 0;
        for (int i = 0; i < model.bodies(); ++i)
            sum += 0.25 * e.segment<3>(6 * i).squaredNorm() + e.segment<3>(6 * i + 3).squaredNorm();
        return std::sqrt(sum);
    }

    void accept(State& x, double h)
    {
        place(x);
        x.lambda = K.constraint_part(z) / (1.5 * h * h);
        b.setZero();
        K.rows().add_transpose(1, x.lambda, b);
        for (int i = 0; i < model.bodies(); ++i) {
            Motion& body = x.body[i];
            body.A = orthonormalised(body.A);
            body.rdot = z.segment<3>(6 * i) / h;
            body.omega_bar = z.segment<3>(6 * i + 3) / h;
            body.rddot = (loads.F[i] - b.segment<3>(6 * i)) / model.mass().m[i];  // Eqs. 3.39, 3.40
            body.omegadot_bar = J_bar_inverse[i] * (tau_bar(i, x_n.body[i]) - b.segment<3>(6 * i + 3));
        }
    }

    std::vector<Mat3> A_hat;  ///< A_n exp(½h ω̄_n) Eq. 3.44
    double half_h = 0;
};

const bool enrolled = enrol<HalfImplicit2>({.name = "rA-half-2",
                                            .order = 2,
                                            .order_lambda = 1,
                                            .formulation = "rA",
                                            .unknowns = "r, h omega, h^2 lambda",
                                            .source = "Fang (2022), Sec. 3.6"});

}  // namespace
}  // namespace hilda::lie
