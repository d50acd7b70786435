// SPDX-License-Identifier: GPL-3.0-or-later
/// Stability limits of spring-dampers in explicit steps.

#pragma once

#include "lie/state.hpp"

namespace hilda::lie {
class Saddle;
}

namespace hilda::dae {

class Model;
using lie::State;

/// Sets Force::spring_limits of all forces from their spring_rows() in the state x. K is factored at x.
///
/// With J the rows of a force, W = J P Jᵀ and P the inverse mass of the constrained bodies,
///
///     P b = v,    | M  Cᵀ | | v |   | b |
///                 | C  0  | | λ | = | 0 |
///
/// a step h is stable as long as the eigenvalues of W (h² k + β h c) are below 4, with the diagonal matrices
/// k and c of the stiffness and damping. β = 2 for symplectic Euler, whose loads use the velocities of the
/// last half step, and β = 4 for leapfrog with extrapolated velocities: the limit is the root -1 of both
/// schemes.
///
/// Each force is treated alone, with the constraints at the start. A step above the limit is unstable;
/// parallel springs may have a smaller limit. Forces in directions in which the constraints permit no motion
/// have no limit.
void set_spring_limits(const Model& model, lie::Saddle& K, const State& x);

}  // namespace hilda::dae
