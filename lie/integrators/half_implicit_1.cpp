// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-half-1: half-implicit (symplectic) Euler on the Lie group with position constraints.
///                                                                                  Fang (2022), Sec. 3.5
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                              (3.24)
///     ṙ_{n+1} = ṙ_n + h r̈_n,    r_{n+1} = r_n + h ṙ_{n+1}                                            (3.25)
///     ω̄_{n+1} = ω̄_n + h ω̄̇_n,    A_{n+1} = A_n exp(h ω̄_{n+1})
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// The unknowns are z = (r_{n+1} - r_n, θ̄ = h ω̄_{n+1}, λ̂ = h² λ_n). (3.27) has r_{n+1} in the place of the
/// increment. The iterates are the same; the increment avoids the cancellation in M r_{n+1} - M r_n. The
/// Newton matrix is K(t_n) (3.32).
///
/// r, A, ṙ, ω̄ and λ are of order 1. The step is that of leapfrog (SHAKE): ṙ_{n+1} and ω̄_{n+1} belong to t_n
/// + h/2. The scheme reports them as the velocities of t_{n+1}, uses them for the loads of t_{n+1}, and
/// starts with ṙ_0 in the place of ṙ_{-½}. These are its errors of first order. They are part of the scheme
/// of the text and are not corrected here; rA-half-1-kick is the corrected scheme.
///
/// Nonholonomic rows are imposed for the mean of the stored velocities, C_n (v_n + v_{n+1}) = 2 ν_n.

#include "lie/schemes.hpp"
#include "lie/steps/half_implicit_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1 final : public HalfImplicitStep {
public:
    HalfImplicit1(const System& model, const Settings& settings)
        : HalfImplicitStep(model, settings, "rA-half-1", 1, 1, ImplicitSprings::Rule::euler)
    {}
};

const bool registered_half_implicit_1 = register_scheme<HalfImplicit1>(
    {.name = "rA-half-1",
     .description = "half-implicit (symplectic) Euler with position constraints",
     .order = 1,
     .order_lambda = 1,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda",
     .uses = newton_options,
     .source = "Fang (2022), Sec. 3.5",
     .supports = {Feature::algebraic, Feature::regularised, Feature::nonholonomic, Feature::redundant,
                  Feature::history, Feature::springs},
     .energy_drifts = true});

}  // namespace
}  // namespace hilda::lie
