// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-half-1-momentum: leapfrog in angular momentum (variational), with position constraints.
///
///     M ṙ_{n+½} + h Φ_rᵀ λ_n = M ṙ_{n-½} + h F_n,    r_{n+1} = r_n + h ṙ_{n+½}
///     J_r(θ)⁻¹ J̄ ω̄_{n+½} + h Π̄ᵀ λ_n = J_r(-θ')⁻¹ J̄ ω̄_{n-½} + h n̄_n,    θ = h ω̄_{n+½},  θ' = h ω̄_{n-½}
///     A_{n+1} = A_n exp(θ̃),    Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// This is the discrete Euler-Lagrange equation of the Lagrangian (1/2h) θᵀ J̄ θ, θ = log(A_nᵀ A_{n+1})
/// (Hante, Arnold 2021): rA-rattle without the projection of velocities. Two angular momenta belong to t_n,
/// both in the body frame of A_n:
///
///     p_n⁺ = J_r(θ)⁻¹ J̄ ω̄_{n+½} of the step after t_n,    p_n⁻ = J_r(-θ')⁻¹ J̄ ω̄_{n-½} of the step before t_n
///     ω̄_n = J̄⁻¹ (p_n⁺ + p_n⁻)/2,   ṙ_n = (ṙ_{n-½} + ṙ_{n+½})/2          velocities reported at t_n
///
/// They contain the gyroscopic torque, which is not evaluated. J_r(-θ) = exp(θ̃) J_r(θ), and J_r(θ) commutes
/// with exp(θ̃) because both are functions of θ̃. Hence J_r(θ)⁻¹ = exp(θ̃) J_r(-θ)⁻¹ and A_n p_n⁺ = A_{n+1}
/// p_{n+1}⁻: the angular momentum in global components is transferred exactly from step to step. For a free
/// system it is constant to rounding.
///
/// Start: p_0⁻ = J̄ ω̄_0 - ½h (J̄ ω̄̇_0 + ω̄_0 × J̄ ω̄_0), solved for ω̄_{-½}. Loads at t_n use the
/// extrapolated velocities of rA-half-1-kick. r, A, ṙ, ω̄ and λ are of order 2.
///
/// The unknowns are z = (r_{n+1} - r_n, θ, h² λ_n), the Newton matrix is K(t_n). J_r(θ)⁻¹ J̄ θ - J̄ θ is part
/// of the residual. State::history is that of rA-half-1-kick.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/steps/leapfrog_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1Momentum final : public LeapfrogStep {
public:
    HalfImplicit1Momentum(const System& model, const Settings& settings)
        : LeapfrogStep(model, settings, "rA-half-1-momentum"), mean_difference(6 * bodies)
    {
        mean_difference.setZero();
    }

private:
    /// J_r(-θ')⁻¹ J̄ ω̄_{-½} = J̄ ω̄_0 - ½h (J̄ ω̄̇_0 + ω̄_0 × J̄ ω̄_0), by fixed-point iteration
    Vec3 half_kick_back(int i, double h) const override
    {
        const Motion& body = x_n.body[i];
        const Mat3& J_bar = mass.J_bar[i];
        const Vec3 H = J_bar * body.omega_bar,
                   target = h * H - 0.5 * h * h * (J_bar * body.omegadot_bar + body.omega_bar.cross(H));
        Vec3 theta = J_bar_inverse[i] * target;
        constexpr int max_iterations = 50;
        double change = 0;
        for (int k = 0; k < max_iterations; ++k) {
            const Vec3 d = J_bar_inverse[i] * (target + momentum(i, -theta));
            theta += d;
            change = d.norm();
            if (change < 1e-16 + 1e-15 * theta.norm()) break;
        }
        if (!(change < 1e-12 * (1 + theta.norm())))
            throw NumericalFailure(
                "newton_diverged",
                name +
                    ": start: the iteration for the angular velocity half a step before the "
                    "start does not converge for " +
                    model.body_name(i) + "; reduce the step");
        return theta / h;
    }

    Vec3 known_moment(int i, double h) const override
    {
        return h * h * loads.n_bar[i] - momentum(i, -h * velocity(i).tail<3>());
    }

    void begin(double step) override
    {
        h = step;
        LeapfrogStep::begin(step);
    }

    void correct(int k, const State& x) override
    {
        set_linear_residual(rows_of_node());
        if (k > 1) K.algebraic_part(e).setZero();  // Φ_αᵀ λ = 0 is linear and already satisfied
        balance_momentum();
        set_constraint_residual(1, x, 1);
        if (K.rows().velocity_rows > 0) set_nonholonomic_residual();
        K.solve(e);
        z += e;
    }

    /// Imposes nonholonomic rows for the ω̄_n of between() in the place of the mean of ω̄_{n-½} and ω̄_{n+½}.
    /// The two differ by O(h²). With the mean, the start would have an error of O(h²), which leaves an
    /// alternating error of O(h) in the multipliers.
    void set_nonholonomic_residual()
    {
        for (int i = 0; i < bodies; ++i) {
            const Vec3 theta = z.segment<3>(6 * i + 3), before = h * velocity(i).tail<3>();
            mean_difference.segment<3>(6 * i + 3) =
                J_bar_inverse[i] * (momentum(i, theta) - momentum(i, -before)) - theta - before;
        }
        const Rows& C = rows_of_node();
        for (int k = C.position_rows(); k < C.rows(); ++k)
            if (!C.is_regularised(k)) K.constraint_part(e)[k] -= C.dot(k, mean_difference);
    }

    /// ω̄_n = J̄⁻¹ (p_n⁺ + p_n⁻)/2
    Vec3 between(int i, const Vec3& before, const Vec3& after, double h) const override
    {
        return J_bar_inverse[i] * (momentum(i, h * after) - momentum(i, -h * before)) / (2 * h);
    }

    Eigen::VectorXd mean_difference;  ///< h (2 ω̄_n - ω̄_{n-½} - ω̄_{n+½}) of each body, ω̄_n of between()
    double h = 0;                     ///< of this step
};

const bool registered_half_implicit_1_momentum = register_scheme<HalfImplicit1Momentum>(
    {.name = "rA-half-1-momentum",
     .description = "leapfrog in angular momentum, the default",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .uses = newton_options,
     .source = "Hante, Arnold (2021) without velocity projection; Fang (2022), Sec. 3.5",
     .loads = LoadEvaluation::extrapolated,
     .supports = {Feature::algebraic, Feature::regularised, Feature::nonholonomic, Feature::redundant,
                  Feature::history, Feature::springs}});

}  // namespace
}  // namespace hilda::lie
