// SPDX-License-Identifier: GPL-3.0-or-later
/// Second-order backward differences on Euler parameters, fully implicit.          Fang (2022), Sec. 2.1.7
///
///     q̇_{n+1} = (4 q̇_n - q̇_{n-1})/3 + (2h/3) q̈_{n+1},    q_{n+1} = (4 q_n - q_{n-1})/3 + (2h/3) q̇_{n+1}
///
/// with the equations of motion, the constraints and the normalisation of p at t_{n+1} (2.30) and the exact
/// Newton matrix 2.32. See formulations/rp_step_equations.hpp.
///
/// The first step assumes an acceleration that is linear in time,
///
///     q̇_1 = q̇_0 + (h/2)(q̈_0 + q̈_1),    q_1 = q_0 + h q̇_0 + h² (q̈_0/3 + q̈_1/6),
///
/// whose local error in q_1 is O(h⁴). The constraints determine the normal part of q̈_1 from Φ(q_1)/h², so
/// the error of λ_1 is O(h²). Backward Euler or the trapezoidal rule would be sufficient for r, p and their
/// velocities, but they cause an error of O(1) or O(h) in λ_1. After a change of h the scheme starts again
/// with this step.
///
/// Order 2 for positions and velocities, and for λ from λ_4 on. λ_2 and λ_3 have an error of O(h): the
/// velocity residuals g = Φ̇ of the nodes 0 and 1 differ from the smooth g = c h² of the later nodes, and
/// λ_{n+1} contains their difference (3g_{n+1} - 4g_n + g_{n-1})/(2h). Example, double_pendulum_moving, error
/// of λ_1 to λ_4: 0.012, 4.4, 1.5, 0.031 N at h = 1e-3 s and 0.003, 2.2, 0.74, 0.0078 N at h = 5e-4 s.

#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"
#include "reference/formulations/rp_implicit.hpp"

namespace hilda::reference {
namespace {

class RpBdf2 final : public RpImplicit {
public:
    RpBdf2(const lie::System& model, const lie::Settings& settings) : RpImplicit(model, settings, "rp-bdf2")
    {}

private:
    int half() const { return static_cast<int>(q_n.size()); }
    int more() const override { return 1 + 2 * half(); }  // h, q_{n-1}, q̇_{n-1}

    void set_formula(double h, bool at_start) override
    {
        if (at_start || step_differs(h)) return set_linear_acceleration(h);
        const auto before = x_n.history.tail(2 * half());
        formula.qdot = (4 * qdot_n - before.tail(half())) / 3;
        formula.q = (4 * q_n - before.head(half())) / 3 + 2 * h / 3 * formula.qdot;
        formula.g_v = 2 * h / 3, formula.g_q = formula.g_v * formula.g_v;
    }

    void save_more(double h, Eigen::Ref<Eigen::VectorXd> out) const override { out << h, q_n, qdot_n; }
};

const bool registered_rp_bdf2 =
    lie::register_scheme<RpBdf2>({.name = "rp-bdf2",
                                  .description = "BDF2 on Euler parameters, index 3",
                                  .order = 2,
                                  .order_lambda = 2,
                                  .formulation = "rp",
                                  .unknowns = "r'', p'', lambda, lambda_P",
                                  .uses = {"--tolerance", "--max-iterations"},
                                  .source = "Fang (2022), Sec. 2.1.7, with BDF2",
                                  .loads = lie::LoadEvaluation::implicit,
                                  .supports = {lie::Feature::history}});

}  // namespace
}  // namespace hilda::reference
