// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions of scenes of free bodies.

#pragma once

#include "contact/friction/friction_pair.hpp"

namespace hilda::contact {

/// Moves the pose over a step h [s] at constant velocities: r ← r + h ṙ, A ← A exp(h ω̄)
void drift(Motion& body, double h);

/// Kinetic energy of all bodies with finite mass or inertia [J]; one inertia per body
double kinetic_energy(const std::vector<Inertia>& inertia, const std::vector<Motion>& body);

}  // namespace hilda::contact
