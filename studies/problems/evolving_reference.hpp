// SPDX-License-Identifier: GPL-3.0-or-later
/// Reference solutions of models with evolving contacts.

#pragma once

#include "lie/schemes.hpp"
#include "studies/framework/problem.hpp"

namespace hilda::studies {

/// Complete states (with accelerations and multipliers) at the given instants [s].
///
/// A ball in a fixed ellipsoidal bowl and an ellipsoid on a fixed plane, frictionless or rolling without
/// slip, are integrated in minimal coordinates, independently of the constraint equations. All other models,
/// including built-in models changed with --set, are integrated by rA-rkmk-4 with steps of at most 1e-4 s.
lie::Trajectory evolving_reference(dae::Description& d, const std::vector<double>& instants);

/// Name of the reference solution in tables
constexpr const char* evolving_reference_name =
    "minimal coordinates (GSL rk8pd) at 1e-13, or rA-rkmk-4 at h = 1e-4 s";

/// Integrates from d.x with steps of at most h [s], adjusted so that every instant is a node. Throws
/// io::UsageError as run::check_run(), and lie::NumericalFailure also for what run::Watch finds.
lie::Trajectory run_with_small_steps(const dae::Description& d, const std::vector<double>& instants,
                                     const lie::Scheme& scheme, double h);

}  // namespace hilda::studies
