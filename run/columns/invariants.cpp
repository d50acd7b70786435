// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/columns/invariants.hpp"

#include <algorithm>

namespace hilda::run {

void Invariants::update(const dae::Model& model, const std::vector<const contact::EvolvingContact*>& contacts,
                        const lie::State& x, double energy, double norm)
{
    if (nodes++ == 0) energy_start = energy;
    energy_end = energy;
    energy_drift = std::max(energy_drift, std::abs(energy - energy_start));
    constraint_norm = std::max(constraint_norm, norm);
    for (const lie::Motion& body : x.body)
        orthogonality = std::max(orthogonality, lie::orthogonality_error(body.A));
    contact.resize(contacts.size());
    for (size_t k = 0; k < contacts.size(); ++k) {
        const auto of = forces(model, *contacts[k], x);
        contact[k].F_N_least = std::min(contact[k].F_N_least, of.F_N);
        contact[k].F_N_most = std::max(contact[k].F_N_most, of.F_N);
        contact[k].lambda_N = std::max(contact[k].lambda_N, of.N.norm());
    }
}

}  // namespace hilda::run
