// SPDX-License-Identifier: GPL-3.0-or-later
/// Quantities of contact constraints (evolving contacts) for the output.

#pragma once

#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/friction.hpp"

namespace hilda::studies {

/// The contact constraints of a model, in the order of the model
std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model);

/// Multipliers of a contact constraint in the state x; zero while the constraint is inactive
contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x);

/// The force elements of a contact constraint; nullptr if there is none
struct ContactForceElements {
    const contact::EvolvingFriction* friction = nullptr;
    const contact::ContactForce* fallback = nullptr;  ///< compliant contact that can replace the constraint
};
/// Searches the forces of the model for those of the contact constraint c.
ContactForceElements find_force_elements(const dae::Model& model, const contact::EvolvingContact& c);

/// Contact loads on body i in the state x: those of the constraint and its friction, or those of the fallback
/// if it is active
struct ContactLoads {
    double F_N = 0;                          ///< normal force [N]
    lie::Vec3 friction = lie::Vec3::Zero();  ///< friction force, global [N]
};
ContactLoads contact_loads(const dae::Model& model, const contact::EvolvingContact& c,
                           const ContactForceElements& of, const lie::State& x);

/// Numbers of degrees of freedom removed by the general constraints: their position and velocity rows without
/// those of implicit friction, minus their algebraic variables
struct RowsOfGeneralConstraints {
    int of_contacts = 0;            ///< that are active in x
    int others = 0, of_others = 0;  ///< number of the other general constraints, and of their rows
};
RowsOfGeneralConstraints rows_of_general_constraints(const dae::Model& model, const lie::State& x);

}  // namespace hilda::studies
