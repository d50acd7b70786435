// SPDX-License-Identifier: GPL-3.0-or-later
/// The choice of the linear solver for the saddle system.

#pragma once

namespace hilda::lie {

/// Linear solver for K z = b
enum class LinearSolver {
    automatic,  ///< algebraic variables eliminated; then `condensed` if it takes fewer operations than KLU
    klu,        ///< KLU for the whole matrix K
    condensed   ///< algebraic variables eliminated; then the Schur complement C M⁻¹ Cᵀ, by blocks
};

}  // namespace hilda::lie
