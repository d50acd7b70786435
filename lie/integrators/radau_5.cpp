// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-radau-5: the three-stage Radau IIA method of order 5 with the velocity constraints at its stages.
///
/// Hairer, Wanner (1996), Solving Ordinary Differential Equations II, Secs. IV.8 and VII.4.
/// lie/steps/radau_step.hpp has the variables, the Newton matrices and the projection.

#include "lie/steps/adaptive_step.hpp"

namespace hilda::lie {
namespace {

const bool registered_radau_5 = register_with_adaptive_steps<RadauStep>(
    {.name = "rA-radau-5",
     .description = "implicit Radau IIA of order 5, index 2, with projection; adaptive or fixed step",
     .order = 5,
     .order_lambda = 5,
     .formulation = "rA",
     .unknowns = "stages of r', omega, lambda",
     .uses = newton_options,
     .source = "Hairer, Wanner (1996), on the Lie group",
     .loads = LoadEvaluation::implicit,
     .supports = {Feature::nonholonomic, Feature::history}});

}  // namespace
}  // namespace hilda::lie
