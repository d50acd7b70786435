// SPDX-License-Identifier: GPL-3.0-or-later
/// A state moved onto the constraints of any lie::System; dae::start() does more, and for dae::Model only.

#pragma once

#include "lie/solver/saddle.hpp"

namespace hilda::reference {

/// Moves r and A onto Φ = 0, by Newton steps that are shortest in the metric of the mass, for as long as they
/// gain; then ṙ and ω̄ onto Φ_r ṙ + Π̄ ω̄ = ν. For states that are close already. Throws lie::NoConvergence when
/// ten steps do not get there.
void project(const lie::System& system, lie::Saddle& K, lie::State& x);

}  // namespace hilda::reference
