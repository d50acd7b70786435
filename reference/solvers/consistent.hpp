// SPDX-License-Identifier: GPL-3.0-or-later
/// Projection of a state onto the constraints of a lie::System.
///
/// dae::start() also checks the rank and computes accelerations, but it accepts a dae::Model only.

#pragma once

namespace hilda::lie {
class Saddle;
struct State;
class System;
}  // namespace hilda::lie

namespace hilda::reference {

/// Projects r and A onto Φ = 0 and then ṙ and ω̄ onto Φ_r ṙ + Π̄ ω̄ = ν.
///
/// The position projection is Newton's method with corrections of minimum length in the mass metric,
///
///     | M    0   Φ_rᵀ | | δr |   |  0 |
///     | 0    J̄   Π̄ᵀ   | | δθ̄ | = |  0 |,    r ← r + δr,  A ← A exp(δθ̄~),
///     | Φ_r  Π̄   0    | | μ  |   | -Φ |
///
/// and stops when the correction is at the level of rounding. The initial state must be close to the
/// constraints.
///
/// K is the saddle matrix of the system; on return it is factored at the projected position. Throws
/// lie::NoConvergence after ten corrections without convergence.
void project(const lie::System& system, lie::Saddle& K, lie::State& x);

}  // namespace hilda::reference
