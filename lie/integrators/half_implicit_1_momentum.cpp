// SPDX-License-Identifier: GPL-3.0-or-later
/// The leapfrog of rA-half-1-kick with the rotations balanced by their angular momentum: second order, and the momentum
/// of a free system is constant to rounding.
///
///     M ṙ_{n+½} + h Φ_rᵀ λ_n = M ṙ_{n-½} + h F_n,    r_{n+1} = r_n + h ṙ_{n+½}
///     J_r(θ)⁻¹ J̄ ω̄_{n+½} + h Π̄ᵀ λ_n = J_r(-θ')⁻¹ J̄ ω̄_{n-½} + h n̄_n,    θ = h ω̄_{n+½},  θ' = h ω̄_{n-½}
///     A_{n+1} = A_n exp(θ),    Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// Both sides are the angular momentum at t_n in the body's frame, as the turn after t_n and the one before it have it.
/// J_r(θ)⁻¹ = exp(θ) J_r(-θ)⁻¹ for what commutes with no more than θ, so that A_n J_r(-θ')⁻¹ J̄ ω̄_{n-½} is the momentum
/// that left the node before. No gyroscopic torque is evaluated. It is rA-rattle without its projection of velocities.
/// K stays the Newton matrix; what J_r differs from 1 goes into the residual.

#include "lie/steps/leapfrog_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1Momentum final : public LeapfrogStep {
public:
    HalfImplicit1Momentum(const System& model, const Settings& settings)
        : LeapfrogStep(model, settings, "rA-half-1-momentum"), beyond(6 * model.bodies())
    {
        beyond.setZero();
    }

private:
    /// J_r(θ)⁻¹ J̄ θ of body i
    Vec3 momentum(int i, const Vec3& theta) const
    {
        return right_jacobian_inverse(theta) * (model.mass().J_bar[i] * theta);
    }

    /// J_r(-θ')⁻¹ J̄ ω̄_{-½} = J̄ ω̄_0 - ½h (J̄ ω̄̇_0 + ω̄_0 × J̄ ω̄_0), by fixed-point iteration
    Vec3 half_kick_back(int i, double h) const override
    {
        const Motion& body = x_n.body[i];
        const Mat3& J_bar = model.mass().J_bar[i];
        const Vec3 H = J_bar * body.omega_bar,
                   wanted = h * H - 0.5 * h * h * (J_bar * body.omegadot_bar + body.omega_bar.cross(H));
        Vec3 theta = J_bar_inverse[i] * wanted;
        constexpr int most = 50;
        double last = 0;
        for (int k = 0; k < most; ++k) {
            const Vec3 d = J_bar_inverse[i] * (wanted + momentum(i, -theta));
            theta += d;
            last = d.norm();
            if (last < 1e-16 + 1e-15 * theta.norm()) break;
        }
        if (!(last < 1e-12 * (1 + theta.norm())))
            throw NumericalFailure("newton_diverged",
                                   name + ": the half kick at the start finds no angular velocity for " +
                                       model.body_name(i) + ": a smaller step is needed");
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
        if (k > 1) K.algebraic_part(e).setZero();  // Φ_αᵀ λ = 0 is linear, and holds
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec3 theta = z.segment<3>(6 * i + 3);
            e.segment<3>(6 * i + 3) -= momentum(i, theta) - model.mass().J_bar[i] * theta;
        }
        set_constraint_residual(1, x, 1);
        if (K.rows().velocity_rows > 0) hold_velocity();
        K.solve(e);
        z += e;
    }

    /// Rows of velocities hold for ω̄_n as between() has it, and not for the mean of ω̄_{n-½} and ω̄_{n+½}: they differ by
    /// O(h²), and a start that is off by so much leaves an alternating error of O(h) in the multipliers.
    void hold_velocity()
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Vec3 theta = z.segment<3>(6 * i + 3), before = h * velocity(i).tail<3>();
            beyond.segment<3>(6 * i + 3) =
                J_bar_inverse[i] * (momentum(i, theta) - momentum(i, -before)) - theta - before;
        }
        const Rows& C = rows_of_node();
        for (int k = C.position_rows(); k < C.rows(); ++k)
            if (!C.is_regularised(k)) K.constraint_part(e)[k] -= C.dot(k, beyond);
    }

    /// ω̄_n of the angular momentum half-way between those on both sides
    Vec3 between(int i, const Vec3& before, const Vec3& after, double h) const override
    {
        return J_bar_inverse[i] * (momentum(i, h * after) - momentum(i, -h * before)) / (2 * h);
    }

    Eigen::VectorXd beyond;  ///< what the rotations of between() have beyond the mean
    double h = 0;            ///< of this step
};

const bool registered = register_scheme<HalfImplicit1Momentum>(
    {.name = "rA-half-1-momentum",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .source = "Fang (2022), Sec. 3.5, as the leapfrog of angular momentum",
     .algebraic = true,
     .nonholonomic = true,
     .regularised = true});

}  // namespace
}  // namespace hilda::lie
