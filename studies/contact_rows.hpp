// SPDX-License-Identifier: GPL-3.0-or-later
/// What results say of contacts that evolve.

#pragma once

#include "contact/evolving_contact.hpp"

namespace hilda::studies {

/// Those of a model, in their order
std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model);

/// Its multipliers in x, all zero while it is open
contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x);

/// The largest scaled residual of a model in x, in m or rad: of all its rows, also the dropped ones, and of the rows of
/// its contacts, which are lengths
double largest_residual(const dae::Model& model, const lie::State& x);

/// Rows of the equations less unknowns without mass: what contacts take from the freedom of a model
int contact_rank(const dae::Model& model);

}  // namespace hilda::studies
