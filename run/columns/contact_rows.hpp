// SPDX-License-Identifier: GPL-3.0-or-later
/// Quantities of contact constraints (evolving contacts) for the output.

#pragma once

#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/friction.hpp"

namespace hilda::run {

/// The contact constraints of a model, in the order of the model
std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model);

/// Multipliers of a contact constraint in the state x; zero while the constraint is inactive
contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x);

/// Numbers of degrees of freedom removed by the general constraints: their position and velocity rows without
/// those of implicit friction, minus their algebraic variables
struct RowsOfGeneralConstraints {
    int of_contacts = 0;            ///< that are active in x
    int others = 0, of_others = 0;  ///< number of the other general constraints, and of their rows
};
RowsOfGeneralConstraints rows_of_general_constraints(const dae::Model& model, const lie::State& x);

}  // namespace hilda::run
