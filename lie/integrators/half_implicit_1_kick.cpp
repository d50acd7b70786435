// SPDX-License-Identifier: GPL-3.0-or-later
/// The half-implicit scheme of first order, started and read as the leapfrog that it is: second order in all.
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                    Fang (2022), 3.24
///     ṙ_{n+½} = ṙ_{n-½} + h r̈_n,   r_{n+1} = r_n + h ṙ_{n+½}                                           3.25
///     ω̄_{n+½} = ω̄_{n-½} + h ω̄̇_n,   A_{n+1} = A_n exp(h ω̄_{n+½})
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// The steps are those of rA-half-1, whose velocities belong to the middle of a step (SHAKE; Ryckaert,
/// Ciccotti, Berendsen 1977). Three things are done with that in mind: the start is a half kick backwards,
/// ṙ_{-½} = ṙ_0 - ½h r̈_0; node velocities are the means (ṙ_{n-½} + ṙ_{n+½})/2; and loads, the gyroscopic torque
/// among them, see the velocities (3 ṙ_{n-½} - ṙ_{n-3/2})/2 extrapolated to t_n. The Newton matrix is that of
/// rA-half-1, and so is the cost.
///
/// The state carries ṙ_{n-½}, ω̄_{n-½} of all bodies, then ṙ_{n-3/2}, ω̄_{n-3/2}.

#include "lie/newton_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1Kick final : public SaddleStep {
public:
    using SaddleStep::SaddleStep;

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        if (x_n.history.size() == 0)
            half_kick(h);
        else
            half_steps = x_n.history;
        extrapolate(node = x_n);
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
        no_convergence("rA-half-1-kick", correction, x);
    }

    bool lags() const override { return true; }
    /// What the step found at t_n, and the mean of the velocities on both sides of it
    void complete(State& node, const State& after) const override
    {
        take_loads(node, after);
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec6 mean = 0.5 * (earlier(after.history, i) + later(after.history, i));
            node.body[i].rdot = mean.head<3>();
            node.body[i].omega_bar = mean.tail<3>();
        }
    }

private:
    using Vec6 = Eigen::Matrix<double, 6, 1>;

    /// (ṙ, ω̄) of body i half a step before the node, and one and a half
    Vec6 later(const Eigen::VectorXd& half_steps, int i) const { return half_steps.segment<6>(6 * i); }
    Vec6 earlier(const Eigen::VectorXd& half_steps, int i) const
    {
        return half_steps.segment<6>(6 * (model.bodies() + i));
    }

    void half_kick(double h)
    {
        half_steps.resize(12 * model.bodies());
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            for (int k = 0; k < 2; ++k)
                half_steps.segment<6>(6 * (k * model.bodies() + i)) << body.rdot - (k + 0.5) * h * body.rddot,
                    body.omega_bar - (k + 0.5) * h * body.omegadot_bar;
        }
    }

    /// ṙ, ω̄ at the node, for the loads there
    void extrapolate(State& x) const
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec6 v = 1.5 * later(half_steps, i) - 0.5 * earlier(half_steps, i);
            x.body[i].rdot = v.head<3>();
            x.body[i].omega_bar = v.tail<3>();
        }
    }

    /// h M ṙ_{n-½} + h² F_n and h J̄ ω̄_{n-½} + h² τ̄_n
    void set_known_part(double h)
    {
        model.loads(node, loads);
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec6 v = later(half_steps, i);
            b.segment<3>(6 * i) = h * model.mass().m[i] * v.head<3>() + h * h * loads.F[i];
            b.segment<3>(6 * i + 3) =
                h * (model.mass().J_bar[i] * v.tail<3>()) + h * h * tau_bar(i, node.body[i]);
        }
        K.constraint_part(b).setZero();
    }

    /// Guess with the accelerations and multipliers of the step before                               Eq. 3.34
    void predict(double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Motion& body = x_n.body[i];
            z.segment<6>(6 * i) = h * later(half_steps, i);
            z.segment<3>(6 * i) += h * h * body.rddot;
            z.segment<3>(6 * i + 3) += h * h * body.omegadot_bar;
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
        const int half = 6 * model.bodies();
        half_steps.tail(half) = half_steps.head(half);
        half_steps.head(half) = z.head(half) / h;
        x.history = half_steps;
        for (int i = 0; i < model.bodies(); ++i) {
            Motion& body = x.body[i];
            body.A = orthonormalised(body.A);
            body.rddot = (loads.F[i] - b.segment<3>(6 * i)) / model.mass().m[i];  // Eq. 3.24
            body.omegadot_bar = J_bar_inverse[i] * (tau_bar(i, node.body[i]) - b.segment<3>(6 * i + 3));
        }
        extrapolate(x);
    }

    State node;                  ///< x_n with velocities at t_n
    Eigen::VectorXd half_steps;  ///< (ṙ, ω̄)_{n-½} of all bodies, then those of n-3/2
};

const bool enrolled =
    enrol<HalfImplicit1Kick>({.name = "rA-half-1-kick",
                              .order = 2,
                              .order_lambda = 2,
                              .formulation = "rA",
                              .unknowns = "r, h omega, h^2 lambda",
                              .source = "Fang (2022), Sec. 3.5, with leapfrog's start and velocities"});

}  // namespace
}  // namespace hilda::lie
