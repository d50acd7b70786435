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
#include "lie/steps/local_coordinate_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class Rkmk4 final : public LocalCoordinateStep {
public:
    Rkmk4(const System& model, const Settings& settings)
        : LocalCoordinateStep(model, settings), sum(12 * bodies), slope(12 * bodies), change(12 * bodies)
    {}

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        // The first stage is the node; its accelerations are known.
        theta.setZero();
        set_slope(x_n, slope);
        sum = slope;
        for (const auto& [c, weight] : {std::pair{0.5, 2.0}, {0.5, 2.0}, {1.0, 1.0}}) {
            change = c * h * slope;
            place(x, change);
            x.t = x_n.t + c * h;
            model.update_alpha(x);
            set_accelerations(x);
            set_slope(x, slope);
            sum += weight * slope;
        }
        sum /= 6;
        change = h * sum;
        place(x, change);
        model.update_alpha(x);
        return done(attempt, finish(x, "rA-rkmk-4"));
    }

private:
    Eigen::VectorXd sum, slope, change;
};

const bool registered_rkmk_4 = register_scheme<Rkmk4>(
    {.name = "rA-rkmk-4",
     .description = "Runge-Kutta-Munthe-Kaas of fourth order on the index-1 equations, with projection",
     .order = 4,
     .order_lambda = 4,
     .formulation = "rA",
     .unknowns = "none; projection",
     .uses = newton_options,
     .source = "Munthe-Kaas (1998), with projection",
     .supports = {Feature::algebraic, Feature::nonholonomic, Feature::redundant, Feature::history}});

}  // namespace
}  // namespace hilda::lie
