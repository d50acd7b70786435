// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle: RATTLE (Andersen 1983) on the Lie group, RATTLie, see RattleStep.       Hante, Arnold (2021)
///
/// Source: Hante, Arnold (2021), J. Comput. Appl. Math. 387, 112492. The scheme is symmetric, also for
/// loads that depend on velocities, and symplectic for loads with a potential. r, A, ṙ, ω̄ and λ are of
/// order 2. The multipliers reported are not λ⁺ and λ⁻ of the half steps: accelerations and multipliers are
/// computed from the saddle system at the node.

#include "lie/schemes.hpp"
#include "lie/steps/rattle_step.hpp"

namespace hilda::lie {
namespace {

class Rattle final : public RattleStep {
public:
    Rattle(const System& model, const Settings& settings) : RattleStep(model, settings, "rA-rattle")
    {
        K.set_refinements(2);
    }

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        return done(attempt, advance(x, h, x_n.t + h));
    }
};

const bool registered_rattle =
    register_scheme<Rattle>({.name = "rA-rattle",
                             .description = "RATTLE on the Lie group (RATTLie), variational",
                             .order = 2,
                             .order_lambda = 2,
                             .formulation = "rA",
                             .unknowns = "r, h omega, h^2 lambda / 2",
                             .uses = newton_options,
                             .source = "Hante, Arnold (2021)",
                             .supports = {Feature::algebraic, Feature::redundant, Feature::history}});

}  // namespace
}  // namespace hilda::lie
