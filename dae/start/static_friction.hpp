// SPDX-License-Identifier: GPL-3.0-or-later
/// Static equilibrium of the springs of friction at a start.

#pragma once

#include "lie/state.hpp"

#include <vector>

namespace hilda::lie {
class Saddle;
}

namespace hilda::dae {

class Model;
using lie::State;

/// A force whose friction cannot hold its bodies at rest
struct Slipping {
    int force = 0;                 ///< number, see Model::for_forces()
    const char* name = "";         ///< of the spring: Force::StaticSpring::name
    double needed = 0, bound = 0;  ///< force or torque that would hold, and its largest value [N, N m]
};

/// Result of set_static_friction()
struct StaticStart {
    std::vector<Slipping> slipping;  ///< forces that cannot hold
    bool has_converged = true;       ///< false: x has remained without deflections
};

/// Stretches the springs of friction whose bodies are at rest relative to each other such that they hold
/// them.
///
/// Springs that start without deflection apply the static load as a jump. The sum of a critically damped
/// spring and its damper then exceeds the static load by 1/e², 13.5 %, and that of an undamped spring by 100
/// %. A body that is held by friction close to its bound would begin to slide.
///
/// The forces f of the springs make the accelerations of their deflections zero:
///
///     J a + γ = 0,   a = M̂⁻¹ (F - Jᵀ f)             with the rows J of the springs (Force::StaticSpring)
///
/// M̂⁻¹ is the inverse mass of the constrained bodies. If there are more springs than the equilibrium
/// determines, such as those below the corners of a box, f has the smallest elastic energy Σ f²/(2 K), to
/// which springs without deflection would come as well. The equations are solved by conjugate residuals
/// (Stiefel 1955) with the factors of K: the cost of an iteration grows linearly with the bodies.
///
/// A spring beyond its bound slips: it has the force of sliding friction in the direction in which it would
/// hold, and the others are solved again. The normal force of a constraint changes with the friction; both
/// are iterated.
///
/// x: state of a start with internal states, accelerations and multipliers, with K factored at x. All three
/// are changed.
///
/// Implicit friction has no forces of its own: the elastic displacements of the bounded pairs of contacts at
/// rest become those of the multipliers of the start, which are the forces of sticking.
StaticStart set_static_friction(const Model& model, lie::Saddle& K, State& x);

}  // namespace hilda::dae
