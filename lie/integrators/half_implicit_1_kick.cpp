// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-half-1-kick: leapfrog with constraints (SHAKE) on the Lie group.
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                    Fang (2022), 3.24
///     ṙ_{n+½} = ṙ_{n-½} + h r̈_n,   r_{n+1} = r_n + h ṙ_{n+½}                                           3.25
///     ω̄_{n+½} = ω̄_{n-½} + h ω̄̇_n,   A_{n+1} = A_n exp(h ω̄_{n+½})
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// The steps are those of rA-half-1, whose stored velocities belong to the middle of a step (SHAKE: Ryckaert,
/// Ciccotti, Berendsen 1977). With u = (ṙ, ω̄), three things differ:
///
///     u_{-½} = u_0 - ½h u̇_0,   u_{-3/2} = u_0 - (3/2)h u̇_0          start with a half kick backwards
///     u_n = (u_{n-½} + u_{n+½})/2                                     velocities reported at t_n
///     (3 u_{n-½} - u_{n-3/2})/2                                       velocities in the loads of t_n
///
/// The loads include the gyroscopic torque. r, A, ṙ, ω̄ and λ are of order 2, also for loads that depend on
/// velocities. Nonholonomic rows are imposed for u_n: C_n (u_{n-½} + u_{n+½}) = 2 ν_n. Unknowns, Newton
/// matrix and cost are those of rA-half-1. An oscillator of frequency Ω is stable for h Ω < 2.
///
/// State::history holds u_{n-½} of all bodies, then u_{n-3/2}.

#include "lie/schemes.hpp"
#include "lie/steps/leapfrog_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1Kick final : public LeapfrogStep {
public:
    HalfImplicit1Kick(const System& model, const Settings& settings)
        : LeapfrogStep(model, settings, "rA-half-1-kick")
    {}
};

const bool registered_half_implicit_1_kick = register_scheme<HalfImplicit1Kick>(
    {.name = "rA-half-1-kick",
     .description =
         "leapfrog (SHAKE): rA-half-1 started with half a kick and read at the nodes; the energy of "
         "spinning bodies drifts",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .uses = newton_options,
     .source = "Fang (2022), Sec. 3.5, with start and velocities of leapfrog",
     .loads = LoadEvaluation::extrapolated,
     .supports = {Feature::algebraic, Feature::regularised, Feature::nonholonomic, Feature::redundant,
                  Feature::history, Feature::springs},
     .energy_drifts = true});

}  // namespace
}  // namespace hilda::lie
