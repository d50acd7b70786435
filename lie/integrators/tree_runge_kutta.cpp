// SPDX-License-Identifier: GPL-3.0-or-later
/// tree-rk-4, tree-dp-5, tree-dop853: explicit Runge-Kutta methods in the joint coordinates of a tree.
///
/// The tableaux are the classical one of order 4 (Kutta 1901) and those of rA-dp-5 and rA-dop853. The
/// equations have no constraints: lie/steps/tree_step.hpp has the variables.

#include "lie/steps/adaptive_step.hpp"

namespace hilda::lie {
namespace {

const Tableau& tree_rk_4()
{
    static const Tableau tableau = {.name = "tree-rk-4",
                                    .order = 4,
                                    .c = {0, 0.5, 0.5, 1, 1},
                                    .a = {{}, {0.5}, {0, 0.5}, {0, 0, 1}, {1. / 6, 1. / 3, 1. / 3, 1. / 6}},
                                    .error = {},
                                    .dense = {}};
    return tableau;
}

Tableau named(Tableau tableau, const char* name)
{
    tableau.name = name;
    return tableau;
}

const Tableau& tree_dp_5()
{
    static const Tableau tableau = named(dormand_prince_5(), "tree-dp-5");
    return tableau;
}

const Tableau& tree_dop853()
{
    static const Tableau tableau = named(dop853(), "tree-dop853");
    return tableau;
}

class TreeRk4 final : public TreeRungeKuttaStep {
public:
    TreeRk4(const System& model, const Settings& settings) : TreeRungeKuttaStep(model, settings, tree_rk_4())
    {}
};

const bool registered_tree_rk_4 = register_scheme<TreeRk4>(
    {.name = "tree-rk-4",
     .description = "classical Runge-Kutta of fourth order in the joint coordinates of a tree",
     .order = 4,
     .order_lambda = 4,
     .formulation = "tree",
     .unknowns = "none",
     .uses = {"--linear-solver"},  // for the multipliers
     .source = "Featherstone (1983), Kutta (1901)",
     .needs_tree = true,
     .supports = {Feature::history}});

const bool registered_tree_dp_5 = register_with_adaptive_steps<TreeRungeKuttaStep, tree_dp_5>(
    {.name = "tree-dp-5",
     .description =
         "explicit Runge-Kutta 5(4) of Dormand and Prince in the joint coordinates of a tree; adaptive or "
         "fixed step",
     .order = 5,
     .order_lambda = 5,
     .formulation = "tree",
     .unknowns = "none",
     .uses = {"--linear-solver"},  // for the multipliers
     .source = "Featherstone (1983), Dormand, Prince (1980)",
     .stability = 1,
     .needs_tree = true,
     .supports = {Feature::history}});

const bool registered_tree_dop853 = register_with_adaptive_steps<TreeRungeKuttaStep, tree_dop853>(
    {.name = "tree-dop853",
     .description =
         "explicit Runge-Kutta 8(5,3) of Hairer in the joint coordinates of a tree; adaptive or fixed step",
     .order = 8,
     .order_lambda = 8,
     .formulation = "tree",
     .unknowns = "none",
     .uses = {"--linear-solver"},  // for the multipliers
     .source = "Featherstone (1983), Hairer, Nørsett, Wanner (1993)",
     .needs_tree = true,
     .supports = {Feature::history}});

}  // namespace
}  // namespace hilda::lie
