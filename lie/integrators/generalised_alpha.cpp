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
/// Source: Brüls, Cardona, Arnold (2012), Mech. Mach. Theory 48, 121-137. The coefficients are those of
/// Chung and Hulbert (1993). ρ = ρ∞ is the spectral radius for infinite frequency (Settings::rho_infinity),
/// from 0 to 0.99: for ρ = 1 errors of λ of each step are not damped, and λ is of order 1.
///
/// Start: a_0 = v̇_0 + (α_m - α_f) h v̈_0 ≈ v̇(t_0 + (α_m - α_f) h), as in Arnold, Brüls, Cardona (2015),
/// Numer. Math. 129, 149-179. a_n is then a second-order approximation of v̇(t_n + (α_m - α_f) h) for all n.
///
/// The velocities of the smooth numerical solution satisfy their constraints up to O(h²) only: in the
/// directions of the rows they differ from the exact ones by
///
///     h² (C_q v̈ + (0, ω̄ × ω̄̇ / 12)),   C_q = 1/6 - β - (α_m - α_f)/2
///
/// the local error of the positions over h. A start with exact velocities would add a transient to λ, a
/// polynomial in n times ρⁿ, of O(h). The start therefore adds this difference to v_0, in the directions of
/// the rows; the same paper.
///
/// The unknowns are z = (x, κ λ) with κ = β h² (1 - α_f)/(1 - α_m). The equations of motion are multiplied by
/// κ. If no load depends on the state, or if there are algebraic variables or redundant rows, the Newton
/// matrix is K, frozen at t_n: it is without gyroscopic, stiffness, damping and curvature terms. Otherwise it
/// is the exact one,
///
///     | M + κ γ/(β h) D + κ K_t J_r   Cᵀ |      K_t, D: lie::Tangent;  J_r = J_r(h ω̄) in the columns of
///     | C J_r                         0  |      the rotations
///
/// and its factors are kept from step to step. They are renewed if a correction decreases by a factor above
/// 0.2, or after five iterations, and from then on in each iteration of the step. The start has a_0 from a
/// trial step, because the loads one explicit step ahead are those of a large deflection of a stiff spring.
///
/// State::history holds a_n of each body, and with the exact matrix the step and the state of its factors.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/solver/tangent.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/saddle_step.hpp"
#include "lie/steps/state_numbers.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <limits>
#include <memory>

namespace hilda::lie {
namespace {

constexpr double most_rho = 0.99;

/// The exact Newton matrix, and the step and the state of its factors
struct ExactMatrix {
    explicit ExactMatrix(const System& model)
        : tangent(model), N(tangent, TangentMatrix<double>::Constraints::position)
    {}

    Tangent tangent;
    TangentMatrix<double> N;
    double h = 0;  ///< 0: not factored
    long renewals = 0;
    State at;
};

class GeneralisedAlpha final : public SaddleStep {
public:
    GeneralisedAlpha(const System& model, const Settings& settings)
        : SaddleStep(model, settings), C(model.pattern()), a_n(6 * bodies), a_next(a_n)
    {
        const double rho = settings.rho_infinity;
        if (!(rho >= 0 && rho <= most_rho))
            reject("rA-genalpha",
                   "rho_infinity must be from 0 to 0.99; with 1 the multipliers are of order 1", rho);
        alpha_m = (2 * rho - 1) / (rho + 1);
        alpha_f = rho / (rho + 1);
        gamma = 0.5 + alpha_f - alpha_m;
        beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
        if (!model.load_pattern().block.empty() && C.algebraic.empty() && !model.keeps_redundant_rows())
            exact = std::make_unique<ExactMatrix>(model);
    }

    int step(State& x, double h) override
    {
        x_n = x;
        // The start perturbs the velocities of x_n.
        if (x.history.size() == 0) given = x;
        Attempt attempt(x, x.history.size() == 0 ? given : x_n);
        if (exact) return step_with_exact_matrix(x, h, attempt);
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

    Statistics statistics() const override
    {
        Statistics all = statistics_with(K);
        if (!exact) return all;
        all.refactorizations += exact->renewals;
        all.condition = exact->N.matrix().reciprocal_condition();
        return all;
    }

private:
    int step_with_exact_matrix(State& x, double h, Attempt& attempt)
    {
        kappa = beta * h * h * (1 - alpha_f) / (1 - alpha_m);
        int k = 0;
        if (x_n.history.size() == 0) {
            exact->h = 0;
            k = start_with_exact_matrix(x, h);
        } else {
            read_history(h);
        }
        k += solve(x, h);
        for (Motion& body : x.body) body.A = orthonormalised(body.A);
        refuse_whole_turns(x, h, "rA-genalpha");
        write_history(x, [this](const auto& block) { transfer_history(exact->h, exact->at, block); });
        return done(attempt, k);
    }

    /// a_0 = v̇_0 + (α_m - α_f) (v̇_1 - v̇_0), with v̇_1 of a trial step from a_0 = v̇_0
    int start_with_exact_matrix(State& x, double h)
    {
        for (int i = 0; i < bodies; ++i) a_n.segment<6>(6 * i) << x_n.body[i].rddot, x_n.body[i].omegadot_bar;
        const int k = solve(x, h);
        for (int i = 0; i < bodies; ++i) {
            Eigen::Matrix<double, 6, 1> ahead;
            ahead << x.body[i].rddot, x.body[i].omegadot_bar;
            e.segment<6>(6 * i) = ahead - a_n.segment<6>(6 * i);
            a_n.segment<6>(6 * i) += (alpha_m - alpha_f) * e.segment<6>(6 * i);
        }
        K.set_shift(shift(h));
        K.assemble(x_n);
        perturb_velocities(h);
        return k;
    }

    /// Sets x to the solution at t_{n+1} with the exact matrix. Returns the number of iterations.
    int solve(State& x, double h)
    {
        constexpr double slow = 0.2;  // contraction with which kept factors are renewed
        constexpr int most_with_kept_factors = 5;
        // The error after an iteration is about θ/(1-θ) times its correction, with the contraction θ. Its
        // part of the tolerance: velocities have the error of the positions, divided by h.
        constexpr double part = 0.01;
        predict(h, 0.5 * h * h, kappa);
        x.t = x_n.t + h;
        bool renew = exact->h != h, diverged = renew;
        for (int k = 1; k <= settings.max_iterations; ++k) {
            place(x, h);
            // The loads of a bad iterate, such as those of a stiff spring far from its length, make a bad
            // matrix.
            if (renew) factor(diverged ? x_n : x, h), ++exact->renewals;
            diverged = false;
            set_residual(x);
            exact->N.solve(e);
            z -= e;
            const double before = correction;
            const bool small = converged(k, length_of_motion(e), constraint_part(e), 1);
            const double theta = k > 1 ? correction / before : slow;
            if (small && (theta >= 0.5 || theta * correction < part * (1 - theta) * settings.tolerance)) {
                place(x, h);
                return k;
            }
            diverged = !renew && !(theta < 1);
            if (diverged) predict(h, 0.5 * h * h, kappa);
            renew = renew || !(theta <= slow) || k >= most_with_kept_factors;
        }
        no_convergence("rA-genalpha", correction, x);
    }

    /// Factors the exact matrix in the state x for the step h.
    void factor(const State& x, double h)
    {
        exact->h = 0;  // in case of an exception
        exact->tangent.evaluate(x);
        for (int i = 0; i < bodies; ++i) exact->N.rotation[i] = right_jacobian(h * x.body[i].omega_bar);
        exact->N.assemble(kappa * gamma / (beta * h), kappa, 1);
        exact->N.factor();
        copy(x, exact->at);
        exact->h = h;
    }

    template <class Block>
    void transfer_history(double& h, State& at, const Block& block)
    {
        block(a_next.data(), a_next.size());
        block(&h, 1);
        block(&at.t, 1);
        for (size_t size : {at.discrete_state.size(), at.internal_state.size()})
            transfer_integer(size, block);
        transfer(at, block);
    }
    /// Gives `saved` the sizes of the states in the history, which a system may change between two steps.
    void resize_saved()
    {
        const Eigen::Index first = a_next.size() + 2;
        if (x_n.history.size() < first + 2) return;
        const double discrete = x_n.history[first], internal = x_n.history[first + 1];
        if (!(discrete >= 0 && internal >= 0 &&
              discrete + internal <= static_cast<double>(x_n.history.size())))
            return;
        saved.discrete_state.resize(static_cast<size_t>(discrete));
        saved.internal_state.resize(static_cast<size_t>(internal));
    }
    /// Reads a_n. If the factors are not those of the history, renews them.
    void read_history(double h)
    {
        copy(x_n, saved);
        resize_saved();
        double saved_h = 0;
        lie::read_history(x_n, "rA-genalpha",
                          [&](const auto& block) { transfer_history(saved_h, saved, block); });
        if (saved.discrete_state != x_n.discrete_state) saved.derived = nullptr;
        a_n = a_next;
        if (saved_h != h) {
            exact->h = 0;
            return;
        }
        bool same = exact->h == saved_h && exact->at.t == saved.t && exact->at.lambda == saved.lambda &&
                    exact->at.discrete_state == saved.discrete_state &&
                    exact->at.internal_state == saved.internal_state;
        for (int i = 0; i < bodies && same; ++i) {
            const Motion &p = exact->at.body[i], &q = saved.body[i];
            same = p.r == q.r && p.A == q.A && p.rdot == q.rdot && p.omega_bar == q.omega_bar;
        }
        if (!same) factor(saved, h);
    }

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
            e.segment<6>(6 * i) -= a_n.segment<6>(6 * i);
            a_n.segment<6>(6 * i) += (alpha_m - alpha_f) * e.segment<6>(6 * i);
        }
        perturb_velocities(h);
    }

    /// Adds the part of h² (C_q v̈ + (0, ω̄ × ω̄̇ / 12)) in the directions of the rows to the velocities of
    /// x_n. e holds h v̈ on entry.
    void perturb_velocities(double h)
    {
        const double C_q = 1. / 6 - beta - 0.5 * (alpha_m - alpha_f);
        b.resize(e.size());
        b.setZero();
        for (int i = 0; i < bodies; ++i) {
            const Motion& body = x_n.body[i];
            e.segment<6>(6 * i) *= h * C_q;
            e.segment<3>(6 * i + 3) += h * h / 12 * body.omega_bar.cross(body.omegadot_bar);
            b.segment<3>(6 * i) = mass.m[i] * e.segment<3>(6 * i);
            b.segment<3>(6 * i + 3) = mass.J_bar[i] * e.segment<3>(6 * i + 3);
        }
        K.solve_in_step(b);  // the part along the constraints
        for (int i = 0; i < bodies; ++i) {
            x_n.body[i].rdot += e.segment<3>(6 * i) - b.segment<3>(6 * i);
            x_n.body[i].omega_bar += e.segment<3>(6 * i + 3) - b.segment<3>(6 * i + 3);
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
        x.lambda = constraint_part(z) / kappa;
    }

    /// The residual e in the state x; the equations of motion multiplied by κ
    void set_residual(const State& x)
    {
        set_motion_residual(x, C);
        e *= kappa;
        model.phi(x, constraint_part(e));
    }

    Rows C;  ///< Φ_r, Π̄ at the iterate
    double alpha_m = 0, alpha_f = 0, beta = 0, gamma = 0, kappa = 0;
    Eigen::VectorXd a_n, a_next;
    std::unique_ptr<ExactMatrix> exact;  ///< null where the Newton matrix is K
    State given;                         ///< the start
    State saved;                         ///< workspace: the state of the factors in a history
};

const bool registered_generalised_alpha = register_scheme<GeneralisedAlpha>(
    {.name = "rA-genalpha",
     .description = "generalised-alpha on SO(3), index 3, with numerical damping",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "increment of (r, A), beta' h^2 lambda",
     .uses = {"--tolerance", "--max-iterations", "--linear-solver", "--rho-infinity"},
     .source = "Bruls, Cardona, Arnold (2012)",
     .loads = LoadEvaluation::implicit,
     .supports = {Feature::algebraic, Feature::redundant, Feature::history}});

}  // namespace
}  // namespace hilda::lie
