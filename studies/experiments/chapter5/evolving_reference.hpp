// SPDX-License-Identifier: GPL-3.0-or-later
/// What models with contacts that evolve are judged by.

#pragma once

#include "studies/framework/problem.hpp"

namespace hilda::studies {

/// Complete states at these instants: of a ball in a fixed ellipsoidal bowl and of an ellipsoid on a fixed plane, without
/// friction or rolling, from the equations in minimal coordinates, which know neither constraint nor multiplier; of
/// anything else, such as a model that has been changed, from rA-rkmk-4 with small steps.
lie::Trajectory evolving_reference(dae::Description& d, const std::vector<double>& instants);

/// What the truth is, for tables
constexpr const char* evolving_truth_name =
    "minimal coordinates (GSL rk8pd) at 1e-13, or rA-rkmk-4 at h = 1e-4 s";

/// Marches from d.x, with steps of at most h that end in the instants.
lie::Trajectory run_with_small_steps(const dae::Description& d, const std::vector<double>& instants,
                                     const lie::Scheme& scheme, double h);

}  // namespace hilda::studies
