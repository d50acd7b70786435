// SPDX-License-Identifier: GPL-3.0-or-later
/// The mass with which a body of a mechanism reacts to a force.

#pragma once

#include "lie/state.hpp"

namespace hilda::lie {
class System;
}

namespace hilda::studies {

/// The smallest mass that a force at the centre of mass of a body accelerates, over all directions [kg]:
///
///     1/λ_max(Y),     r̈ = Y F     from the saddle system with the force F alone
///
/// It is the mass of a free body, and infinite if the constraints and drivers prescribe the motion of the
/// centre. A force beside the centre of mass also turns the body and accelerates a smaller mass.
///
/// Throws lie::SingularMatrix.
double effective_mass(const lie::System& system, const lie::State& x, int body);

}  // namespace hilda::studies
