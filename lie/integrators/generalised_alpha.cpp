// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-genalpha: generalised-α method on the Lie group, index 3.            Brüls, Cardona, Arnold (2012)
///
///     M r̈ + Φ_rᵀ λ = F,   J̄ ω̄̇ + Π̄ᵀ λ = τ̄,   Φ = 0       all at t_{n+1}
///     (1 - α_m) a_{n+1} + α_m a_n = (1 - α_f) v̇_{n+1} + α_f v̇_n,         v̇ = (r̈, ω̄̇)
///     q_{n+1} = q_n ∘ exp(x),  x = h v_n + h² (½ - β) a_n + h² β a_{n+1}
///     v_{n+1} = v_n + h (1 - γ) a_n + h γ a_{n+1}
///
///     α_m = (2ρ - 1)/(ρ + 1),   α_f = ρ/(ρ + 1),   γ = ½ + α_f - α_m,   β = (γ + ½)²/4
///
/// Source: Brüls, Cardona, Arnold (2012), Mech. Mach. Theory 48, 121-137. The coefficients are those of Chung
/// and Hulbert (1993). ρ = ρ∞ in [0, 1] is the spectral radius for infinite frequency
/// (Settings::rho_infinity).
///
/// Start: a_0 = v̇_0 + (α_m - α_f) h v̈_0 ≈ v̇(t_0 + (α_m - α_f) h), as in Arnold, Brüls, Cardona (2015),
/// Numer. Math. 129, 149-179. a_n is then a second-order approximation of v̇(t_n + (α_m - α_f) h) for all n.
///
/// r, A, ṙ, ω̄ and λ are of order 2. The multipliers of the first nodes have an error of O(h) nevertheless:
/// the velocities of a consistent start satisfy their constraints exactly, those of the smooth numerical
/// solution up to O(h²) only. The difference is a transient, a polynomial in n times ρⁿ. Example:
/// double_pendulum_moving, ρ = 0.8: the error of λ reaches 23, 12 and 5.8 N at h = 2e-3, 1e-3 and 5e-4 s. For
/// ρ = 1 the transient is not damped.
///
/// The unknowns are z = (x, κ λ) with κ = β h² (1 - α_f)/(1 - α_m). The equations of motion are multiplied by
/// κ. The Newton matrix without gyroscopic, stiffness, damping and curvature terms is then K; it is frozen at
/// t_n. The iteration diverges if the stiffness of a load exceeds about m/h². State::history holds a_n of
/// each body.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/saddle_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class GeneralisedAlpha final : public SaddleStep {
public:
    GeneralisedAlpha(const System& model, const Settings& settings)
        : SaddleStep(model, settings), C(model.pattern()), a_n(6 * bodies), a_next(a_n)
    {
        const double rho = settings.rho_infinity;
        if (!(rho >= 0 && rho <= 1)) reject("rA-genalpha", "rho_infinity must be from 0 to 1", rho);
        alpha_m = (2 * rho - 1) / (rho + 1);
        alpha_f = rho / (rho + 1);
        gamma = 0.5 + alpha_f - alpha_m;
        beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
    }

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        if (x_n.history.size() == 0)
            start(h);
        else
            a_n = x_n.history;
        kappa = beta * h * h * (1 - alpha_f) / (1 - alpha_m);
        K.set_shift(shift(h));
        K.assemble(x_n);                 // the Newton matrix, frozen at t_n
        predict(h, 0.5 * h * h, kappa);  // the increment of constant accelerations
        start_redundant();
        x.t = x_n.t + h;
        for (int k = 1; k <= most_iterations; ++k) {
            place(x, h);
            set_residual(x);
            K.solve(e);
            z -= e;
            if (converged(k, length_of_motion(e), K.constraint_part(e), 1)) {
                place(x, h);
                for (Motion& body : x.body) body.A = orthonormalised(body.A);
                refuse_whole_turns(x, h, "rA-genalpha");
                x.history = a_next;
                if (K.keeps_redundant_rows()) minimise_multipliers(x);
                return done(attempt, k);
            }
        }
        no_convergence("rA-genalpha", correction, x);
    }

private:
    /// a_0 = v̇_0 + (α_m - α_f) h v̈_0, where h v̈_0 is the difference of v̇_0 and the accelerations of a
    /// state one step ahead
    void start(double h)
    {
        State ahead = x_n;
        ahead.t += h;
        for (Motion& body : ahead.body) {
            body.r += h * body.rdot + 0.5 * h * h * body.rddot;
            body.A = body.A * exp(h * body.omega_bar + 0.5 * h * h * body.omegadot_bar);
            body.rdot += h * body.rddot;
            body.omega_bar += h * body.omegadot_bar;
        }
        model.update_alpha(ahead);
        K.set_shift(shift(h));
        K.assemble(ahead);
        set_load_terms(model, K, ahead, loads, e);
        K.solve_in_step(e);
        for (int i = 0; i < bodies; ++i) {
            a_n.segment<6>(6 * i) << x_n.body[i].rddot, x_n.body[i].omegadot_bar;
            a_n.segment<6>(6 * i) +=
                (alpha_m - alpha_f) * (e.segment<6>(6 * i) - a_n.segment<6>(6 * i)).eval();
        }
    }

    /// The multipliers of minimum norm at the end x of a step
    void minimise_multipliers(State& x)
    {
        K.assemble(x);
        K.minimise_multipliers(z);
        x.lambda = K.constraint_part(z) / kappa;
    }

    /// The state x at t_{n+1}, and a_{n+1}, from z
    void place(State& x, double h)
    {
        for (int i = 0; i < bodies; ++i) {
            using Vec6 = Eigen::Matrix<double, 6, 1>;
            const Motion& from = x_n.body[i];
            Motion& body = x.body[i];
            const Vec6 increment = z.segment<6>(6 * i), a = a_n.segment<6>(6 * i);
            Vec6 v_n, vdot_n;
            v_n << from.rdot, from.omega_bar;
            vdot_n << from.rddot, from.omegadot_bar;
            const Vec6 a_new = (increment - h * v_n - h * h * (0.5 - beta) * a) / (beta * h * h);
            const Vec6 v = v_n + h * (1 - gamma) * a + h * gamma * a_new;
            const Vec6 vdot = ((1 - alpha_m) * a_new + alpha_m * a - alpha_f * vdot_n) / (1 - alpha_f);
            a_next.segment<6>(6 * i) = a_new;
            body.rdot = v.head<3>(), body.omega_bar = v.tail<3>();
            body.rddot = vdot.head<3>(), body.omegadot_bar = vdot.tail<3>();
        }
        place_increments(x);
        place_algebraic(x, 1);
        x.lambda = K.constraint_part(z) / kappa;
    }

    /// The residual e in the state x; the equations of motion multiplied by κ
    void set_residual(const State& x)
    {
        set_motion_residual(x, C);
        e *= kappa;
        model.phi(x, K.constraint_part(e));
    }

    Rows C;  ///< Φ_r, Π̄ at the iterate
    double alpha_m = 0, alpha_f = 0, beta = 0, gamma = 0, kappa = 0;
    Eigen::VectorXd a_n, a_next;
};

const bool registered = register_scheme<GeneralisedAlpha>(
    {.name = "rA-genalpha",
     .description = "generalised-alpha on SO(3), index 3, with numerical damping",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "increment of (r, A), beta' h^2 lambda",
     .source = "Bruls, Cardona, Arnold (2012)",
     .loads = LoadEvaluation::extrapolated,
     .algebraic = true,
     .redundant = true,
     .rho_infinity = true});

}  // namespace
}  // namespace hilda::lie
