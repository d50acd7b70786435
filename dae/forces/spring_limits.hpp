// SPDX-License-Identifier: GPL-3.0-or-later
/// Stability limits of spring-dampers in explicit steps.

#pragma once

#include "lie/state.hpp"

namespace hilda::lie {
struct Mass;
class Saddle;
}  // namespace hilda::lie

namespace hilda::dae {

class Model;
using lie::State;
using lie::Vec3;

/// Inverse effective mass of a free body along a row (r, pi): r · r/m + pi · J̄⁻¹ pi
double free_mobility(const lie::Mass& mass, int body, const Vec3& r, const Vec3& pi);

/// Sets Force::spring_limits of all forces from their spring_rows() in the state x. K is factored at x.
///
/// With J the rows of a force, W = J P Jᵀ and P the inverse mass of the constrained bodies,
///
///     P b = v,    | M  Cᵀ | | v |   | b |
///                 | C  0  | | λ | = | 0 |
///
/// the limits are those of lie::LinearSprings with this W and the stiffness and damping of the rows.
///
/// Each force is treated alone, with the constraints at the start. A step above the limit is unstable;
/// parallel springs may have a smaller limit. Forces in directions in which the constraints permit no motion
/// have no limit.
void set_spring_limits(const Model& model, lie::Saddle& K, const State& x);

}  // namespace hilda::dae
