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

/// Angle by which the friction force of a sliding contact lags behind the direction of the slip.
///
/// A sliding contact deflects its friction spring by μ N/K_E. If the bodies spin about the normal with the
/// relative angular velocity ω_n, the deflection turns with them. The friction law turns it back into the
/// direction of the slip, which leaves about the angle
///
///     |ω_n| μ N / (K_E |slip|)      [rad]
///
/// If this angle is not small, the friction force is not opposed to the slip, and the motion may differ from
/// that of rigid Coulomb friction for any step: a spinning ball with an eccentric centre of mass turns over.
///
/// omega_n [rad/s], bound μ N [N], K_E [N/m], slip [m/s]. 0 for a slip up to 1e-6 m/s.
double friction_lag(double omega_n, double bound, double K_E, double slip);

/// A warning for each contact of the model with friction springs whose friction_lag() in the state x, after
/// dae::start(), is above 0.05 rad. A contact that rolls, with a slip below 0.5 % of the velocities of its
/// surfaces, has none.
std::vector<std::string> soft_friction_warnings(const dae::Model& model, const lie::State& x);

}  // namespace hilda::contact
