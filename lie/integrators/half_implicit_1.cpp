// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit Lie-group scheme of first order.                                   Fang (2022), Sec. 3.5
///
///     M r̈_n + Φ_rᵀ λ_n = F_n,   J̄ ω̄̇_n + Π̄ᵀ λ_n = τ̄_n        all at t_n                              (3.24)
///     ṙ_{n+1} = ṙ_n + h r̈_n,    r_{n+1} = r_n + h ṙ_{n+1}                                            (3.25)
///     ω̄_{n+1} = ω̄_n + h ω̄̇_n,    A_{n+1} = A_n exp(h ω̄_{n+1})
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0
///
/// The unknowns are z = (r_{n+1} - r_n, θ̄ = h ω̄_{n+1}, λ̂ = h² λ_n): the increment instead of the r_{n+1} of
/// (3.27), which changes no iterate but keeps the digits that M r_{n+1} - M r_n would lose.
///
/// ṙ_{n+1} and ω̄_{n+1} are reported as the scheme stores them. They are the velocities at t_n + h/2 rather than
/// at t_{n+1}, which is its first-order error; converting them would hide what the orders are measured for.

#include "lie/steps/half_implicit_step.hpp"

namespace hilda::lie {
namespace {

class HalfImplicit1 final : public HalfImplicitStep {
public:
    HalfImplicit1(const System& model, const Settings& settings)
        : HalfImplicitStep(model, settings, "rA-half-1", 1, 1)
    {}

private:
    void place(State& x) const override
    {
        for (int i = 0; i < model.bodies(); ++i) {
            x.body[i].r = x_n.body[i].r + z.segment<3>(6 * i);
            x.body[i].A = x_n.body[i].A * exp(z.segment<3>(6 * i + 3));
        }
    }
};

const bool registered = register_scheme<HalfImplicit1>({.name = "rA-half-1",
                                                        .order = 1,
                                                        .order_lambda = 1,
                                                        .formulation = "rA",
                                                        .unknowns = "r, h omega, h^2 lambda",
                                                        .source = "Fang (2022), Sec. 3.5",
                                                        .algebraic = true,
                                                        .nonholonomic = true,
                                                        .regularised = true});

}  // namespace
}  // namespace hilda::lie
