// SPDX-License-Identifier: GPL-3.0-or-later
/// Backward Euler on Euler parameters, fully implicit.                             Fang (2022), Sec. 2.1.7
///
///     q̇_{n+1} = q̇_n + h q̈_{n+1},    q_{n+1} = q_n + h q̇_{n+1}                                  (2.28, 2.29)
///
/// with the equations of motion, the constraints and the normalisation of p at t_{n+1} (2.30) and the exact
/// Newton matrix 2.32. See formulations/rp_step_equations.hpp.
///
/// Order 1 for positions, velocities and λ. λ of the first computed node has an error of O(1) if the motion
/// does not start from rest: backward Euler determines the normal part of q̈_1 from Φ(q_1)/h², and its error
/// in q_1 is O(h²).
///
/// In p, a steady rotation at ω is an oscillation with the frequency ω/2, which backward Euler damps
/// (rA-full-1 preserves it): with the half angles a_n of the steps, 2 sin a_{n+1} = sin(a_{n+1} + a_n), hence
/// ω̇ = -h ω³/4.

#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "reference/formulations/rp_implicit.hpp"

namespace hilda::reference {
namespace {

class RpFull1 final : public RpImplicit {
public:
    RpFull1(const lie::System& model, const lie::Settings& settings)
        : RpImplicit(model, settings, "rp-full-1")
    {}

private:
    void set_formula(double h, bool) override
    {
        formula.qdot = qdot_n;
        formula.q = q_n + h * qdot_n;
        formula.g_v = h, formula.g_q = h * h;
    }
};

const bool registered_rp_full_1 =
    lie::register_scheme<RpFull1>({.name = "rp-full-1",
                                   .description = "backward Euler on Euler parameters, index 3",
                                   .order = 1,
                                   .order_lambda = 1,
                                   .formulation = "rp",
                                   .unknowns = "r'', p'', lambda, lambda_P",
                                   .uses = {"--tolerance", "--max-iterations"},
                                   .source = "Fang (2022), Sec. 2.1.7",
                                   .loads = lie::LoadEvaluation::implicit,
                                   .supports = {lie::Feature::history}});

}  // namespace
}  // namespace hilda::reference
