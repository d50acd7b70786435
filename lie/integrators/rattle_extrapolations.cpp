// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle-gbs-4, rA-rattle-gbs-6, rA-rattle-gbs-8: extrapolation of RATTLE steps.
///
/// T_j is the result of j steps of length h/j from t_n. The step is symmetric, so that its error is a series
/// in h², and
///
///     Σ_j w_j T_j,   w_j = Π_{i≠j} j²/(j² - i²),   j = 1 … k        Hairer, Nørsett, Wanner (1993), Sec. II.9
///
/// is of order 2k (Gragg; Bulirsch, Stoer 1966). The sums are those of the changes of r, ṙ and ω̄ and of the
/// rotation vectors log(A_nᵀ A_j). The result is projected onto the constraints; its multipliers are those
/// of its saddle system. All internal steps are positive. The sum is neither symplectic nor symmetric: for
/// long times see the compositions, which need more steps for the same order (3, 6, 10 here; 5, 9, 17 there).
///
/// r, A, ṙ, ω̄ and λ are of order 2k.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/so3.hpp"
#include "lie/steps/rattle_step.hpp"
#include "lie/system.hpp"

#include <utility>

namespace hilda::lie {
namespace {

template <int k>
class Extrapolation final : public RattleStep {
public:
    Extrapolation(const System& model, const Settings& settings)
        : RattleStep(model, tightened(settings), "rA-rattle-gbs-" + std::to_string(2 * k)), sum(12 * bodies)
    {}

    int step(State& x, double h) override
    {
        refuse_history(x, name,
                       "loads with a history (friction, plasticity) are constant during a step and limit its "
                       "order to 1; rA-rattle takes such models");
        start = x;
        Attempt attempt(x, start);
        int iterations = 0;
        sum.setZero();
        for (int j = 1; j <= k; ++j) {
            x = start;
            for (int i = 1; i <= j; ++i) {
                x_n = x;
                iterations += advance(x, h / j, i < j ? start.t + i * h / j : start.t + h);
            }
            add(weight(j), x);
        }
        set_pose(x);
        iterations += finish(x, name);
        return done(attempt, iterations);
    }

private:
    /// The errors of Newton's method have to be small compared with the error of the extrapolation.
    static Settings tightened(Settings settings)
    {
        settings.tolerance *= 1e-3;
        return settings;
    }

    static double weight(int j)
    {
        double w = 1;
        for (int i = 1; i <= k; ++i)
            if (i != j) w *= double(j) * j / (double(j) * j - double(i) * i);
        return w;
    }

    /// Adds the changes of (r, θ, ṙ, ω̄) from the start, times a weight.
    void add(double w, const State& x)
    {
        for (int i = 0; i < bodies; ++i) {
            const Motion &from = start.body[i], &to = x.body[i];
            sum.segment<3>(12 * i) += w * (to.r - from.r);
            sum.segment<3>(12 * i + 3) += w * log(from.A.transpose() * to.A);
            sum.segment<3>(12 * i + 6) += w * (to.rdot - from.rdot);
            sum.segment<3>(12 * i + 9) += w * (to.omega_bar - from.omega_bar);
        }
    }

    void set_pose(State& x)
    {
        for (int i = 0; i < bodies; ++i) {
            const Motion& from = start.body[i];
            Motion& to = x.body[i];
            to.r = from.r + sum.segment<3>(12 * i);
            to.A = orthonormalised(from.A * exp(sum.segment<3>(12 * i + 3)));
            to.rdot = from.rdot + sum.segment<3>(12 * i + 6);
            to.omega_bar = from.omega_bar + sum.segment<3>(12 * i + 9);
        }
    }

    State start;
    Eigen::VectorXd sum;  ///< of (r, θ, ṙ, ω̄) for each body
};

Scheme extrapolation(int order)
{
    return {.name = "rA-rattle-gbs-" + std::to_string(order),
            .description = "extrapolation of rA-rattle, of order " + std::to_string(order),
            .order = order,
            .order_lambda = order,
            .formulation = "rA",
            .unknowns = "r, h omega, h^2 lambda / 2",
            .uses = newton_options,
            .source = "Bulirsch, Stoer (1966)",
            .energy_drifts = true};
}

const bool registered_rattle_extrapolations = register_scheme<Extrapolation<2>>(extrapolation(4)) &&
                                              register_scheme<Extrapolation<3>>(extrapolation(6)) &&
                                              register_scheme<Extrapolation<4>>(extrapolation(8));

}  // namespace
}  // namespace hilda::lie
