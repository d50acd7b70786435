// SPDX-License-Identifier: GPL-3.0-or-later
/// What scenes of bodies without joints have in common.

#pragma once

#include "contact/friction/friction_pair.hpp"

namespace hilda::contact {

/// r + h ṙ and A exp(h ω̄): the pose after a step h [s] with the velocities of the body as they are
void drift(Motion& body, double h);

/// Of all that moves [J]; one inertia for each body
double kinetic_energy(const std::vector<Inertia>& inertia, const std::vector<Motion>& body);

}  // namespace hilda::contact
