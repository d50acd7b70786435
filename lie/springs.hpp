// SPDX-License-Identifier: GPL-3.0-or-later
/// Springs and dampers of a system whose loads a scheme may evaluate implicitly.

#pragma once

#include "lie/rows.hpp"

#include <vector>

namespace hilda::lie {

/// The deflections S of springs and dampers, and the derivatives of their loads.
///
/// Row n has the derivatives C of the deflection: Ṡ = C v, S̈ = C v̇ + γ with v = (ṙ, ω̄). Its load f in the
/// direction of the deflection acts on the bodies as -Cᵀ f and is part of System::loads(). A row without load
/// has zero derivatives in C.
struct Springs {
    Rows rows;
    std::vector<double> stiffness;  ///< ∂f/∂S [N/m], or [N m/rad] for a rotation
    std::vector<double> damping;    ///< ∂f/∂Ṡ [N s/m], or [N m s/rad]
    std::vector<double> gamma;      ///< γ [m/s²], or [rad/s²]
};

}  // namespace hilda::lie
