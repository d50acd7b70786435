// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction springs that are too soft for a sliding contact that spins.

#pragma once

#include "lie/state.hpp"

#include <string>
#include <vector>

namespace hilda::dae {
class Model;
}

namespace hilda::contact {

/// Softness of the friction spring of a sliding contact.
///
/// A sliding contact deflects its spring by μ N/K_E. If the bodies spin about the normal with the relative
/// angular velocity ω_n, the deflection turns with them, and the spring lags behind the direction of the slip
/// by about
///
///     softness = |ω_n| μ N / (K_E |slip|)      [rad]
///
/// With a softness that is not small the friction force is not opposed to the slip, and the motion may differ
/// from that of rigid Coulomb friction for any step: a spinning ball with an eccentric centre of mass turns
/// over. 0 for a contact without slip.
double softness(double omega_n, double bound, double K_E, double slip);

/// A warning for each contact of the model with friction springs whose softness in the state x, after
/// dae::start(), is above 0.05. A contact that rolls, with a slip below 0.5 % of the velocities of its surfaces, has none.
std::vector<std::string> soft_friction_warnings(const dae::Model& model, const lie::State& x);

}  // namespace hilda::contact
