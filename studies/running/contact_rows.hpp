// SPDX-License-Identifier: GPL-3.0-or-later
/// What results say of contacts that evolve.

#pragma once

#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/friction.hpp"

namespace hilda::studies {

/// Those of a model, in their order
std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model);

/// Its multipliers in x, all zero while it is open
contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x);

/// The forces of a contact that evolves; nullptr where there is none
struct ContactForces {
    const contact::EvolvingFriction* friction = nullptr;
    const contact::ContactForce* fallback = nullptr;  ///< stands by until the constraint has handed over
};
ContactForces forces_of(const dae::Model& model, const contact::EvolvingContact& c);

/// What acts on body i of a contact in x, from the constraint and its friction or from what it has handed over to
struct OnBodyI {
    double F_N = 0;                          ///< [N]
    lie::Vec3 friction = lie::Vec3::Zero();  ///< [N, global]
};
OnBodyI on_body_i(const dae::Model& model, const contact::EvolvingContact& c, const ContactForces& of,
                  const lie::State& x);

/// Rows of the equations less unknowns without mass: what contacts that hold in x take from the freedom of a model
int contact_rank(const dae::Model& model, const lie::State& x);

}  // namespace hilda::studies
