// SPDX-License-Identifier: GPL-3.0-or-later
/// Integrators ida-rp, ida-rp-baumgarte and ida-rp-index1: SUNDIALS IDA on the equations of motion in Euler
/// parameters, one integrator for each form of the constraints. See solvers/ida_solver.hpp and
/// solvers/rp_equations.hpp.

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "reference/solvers/ida_solver.hpp"

namespace hilda::reference {
namespace {

template <RpForm form>
class Ida final : public lie::Integrator, public RankMonitor {
public:
    Ida(const lie::System& system, const lie::Settings& settings) : solver(system, settings, form) {}

    int step(lie::State& x, double h) override { return solver.step(x, h); }
    bool chooses_internal_steps() const override { return true; }
    const lie::System& system() const override { return solver.system(); }
    lie::Statistics statistics() const override { return solver.statistics(); }
    Smallest smallest_condition() const override { return solver.smallest_condition(); }

private:
    IdaSolver solver;
};

template <RpForm form>
bool register_ida(const std::string& name, const std::string& unknowns, const std::string& how)
{
    return lie::register_scheme<Ida<form>>(
        {.name = name,
         .description = "variable-order BDF (SUNDIALS IDA) on Euler parameters, " + how,
         .order = 5,
         .order_lambda = 5,
         .formulation = "rp",
         .unknowns = unknowns,
         .uses = {"--rtol", "--atol", "--max-step"},
         .source = "SUNDIALS IDA; Fang (2022), Eq. 2.23",
         .adaptive = true,
         .resumes = false,
         .loads = lie::LoadEvaluation::implicit});
}

const bool ggl = register_ida<RpForm::ggl>("ida-rp", "r, p, r', p', lambda, mu", "GGL-stabilised index 2");
const bool baumgarte = register_ida<RpForm::baumgarte>("ida-rp-baumgarte", "r, p, r', p', lambda",
                                                       "Baumgarte stabilisation, 20/s");
const bool index1 =
    register_ida<RpForm::index1>("ida-rp-index1", "r, p, r', p', lambda", "index 1 without stabilisation");

}  // namespace
}  // namespace hilda::reference
