// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rkmk-4: Runge-Kutta-Munthe-Kaas method of fourth order on the index-1 equations, with projection.
///
///     A = A_n exp(θ̃),   θ̇ = J_r(θ)⁻¹ ω̄,   (r̈, ω̄̇, λ) from K (r̈, ω̄̇, λ) = (F, τ̄, γ)
///
/// is integrated in (r, θ, ṙ, ω̄) with the classical tableau.  Munthe-Kaas (1998), BIT 38, 92-111; Kutta
/// (1901)
///
/// After each step the positions are projected onto Φ = 0 by Newton steps with K of the last stage, then the
/// velocities onto Φ_r ṙ + Π̄ ω̄ = ν. The corrections are the shortest in the metric of the mass. They are of
/// the size of the local error, so the order remains 4 (Hairer, Lubich, Wanner 2006, Sec. IV.4). λ is of
/// order 4 as well. The number of iterations reported is that of the projection of positions.
///
/// The scheme is explicit: a stiff load limits the step.

#include "lie/schemes.hpp"
#include "lie/steps/node_step.hpp"
#include "lie/steps/projection.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class Rkmk4 final : public NodeStep {
public:
    Rkmk4(const System& model, const Settings& settings)
        : NodeStep(model, settings), sum(12 * bodies), slope(12 * bodies), theta(3 * bodies)
    {}

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        // The first stage is the node; its accelerations are known.
        theta.setZero();
        set_slope(x_n);
        sum = slope;
        for (const auto& [c, weight] : {std::pair{0.5, 2.0}, {0.5, 2.0}, {1.0, 1.0}}) {
            place(x, c * h, slope);
            x.t = x_n.t + c * h;
            model.update_alpha(x);
            set_accelerations(x);
            set_slope(x);
            sum += weight * slope;
        }
        sum /= 6;
        place(x, h, sum);
        model.update_alpha(x);
        const int k = project_positions(x);
        assemble_once(x);
        set_momenta(model, x, e);
        solve_velocities(model, K, x, e);
        set_accelerations(x);
        return done(attempt, k);
    }

private:
    using Vec12 = Eigen::Matrix<double, 12, 1>;

    /// d/dt (r, θ, ṙ, ω̄) of the stage x
    void set_slope(const State& x)
    {
        for (int i = 0; i < bodies; ++i) {
            const Motion& body = x.body[i];
            slope.segment<12>(12 * i) << body.rdot,
                right_jacobian_inverse(theta.segment<3>(3 * i)) * body.omega_bar, body.rddot,
                body.omegadot_bar;
        }
    }

    /// x = x_n advanced by h times the slopes `by`
    void place(State& x, double h, const Eigen::VectorXd& by)
    {
        for (int i = 0; i < bodies; ++i) {
            const Motion& from = x_n.body[i];
            Motion& body = x.body[i];
            const Vec12 d = h * by.segment<12>(12 * i);
            theta.segment<3>(3 * i) = d.segment<3>(3);
            body.r = from.r + d.head<3>();
            body.A = from.A * exp(d.segment<3>(3));
            body.rdot = from.rdot + d.segment<3>(6);
            body.omega_bar = from.omega_bar + d.tail<3>();
        }
    }

    /// Projection onto Φ = 0 by Newton steps with K of the last stage. Returns their number.
    int project_positions(State& x)
    {
        for (int k = 1; k <= settings.max_iterations; ++k) {
            set_position_residual(model, K, x, e);
            K.solve(e);
            move(K, x, e);
            if (converged(k, length_of_motion(e), K.constraint_part(e), 0)) return k;
        }
        no_convergence("rA-rkmk-4", correction, x);
    }

    Eigen::VectorXd sum, slope, theta;  ///< θ of each body at the stage
};

const bool registered = register_scheme<Rkmk4>(
    {.name = "rA-rkmk-4",
     .description = "Runge-Kutta-Munthe-Kaas of fourth order on the index-1 equations, with projection",
     .order = 4,
     .order_lambda = 4,
     .formulation = "rA",
     .unknowns = "none; projection",
     .source = "Munthe-Kaas (1998), with projection",
     .algebraic = true,
     .nonholonomic = true});

}  // namespace
}  // namespace hilda::lie
