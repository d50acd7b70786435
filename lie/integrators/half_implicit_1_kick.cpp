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

#include "lie/steps/leapfrog_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1Kick final : public LeapfrogStep {
public:
    HalfImplicit1Kick(const System& model, const Settings& settings)
        : LeapfrogStep(model, settings, "rA-half-1-kick")
    {}
};

const bool registered = register_scheme<HalfImplicit1Kick>(
    {.name = "rA-half-1-kick",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .source = "Fang (2022), Sec. 3.5, with leapfrog's start and velocities",
     .algebraic = true,
     .nonholonomic = true,
     .regularised = true});

}  // namespace
}  // namespace hilda::lie
