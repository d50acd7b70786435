// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/columns/invariants.hpp"

#include <fmt/format.h>

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

std::vector<std::string> warnings(const Invariants& of, const dae::Model& model)
{
    std::vector<std::string> all;
    const auto contacts = evolving_contacts(model);
    for (size_t k = 0; k < contacts.size(); ++k) {
        const ContactExtremes& c = of.contact[k];
        if (c.normals_differ() && c.lambda_N > ContactExtremes::rounding(model))
            all.push_back(fmt::format(
                "contact '{}': lambda_N reaches {:.1e} N at a normal force of {:.1e} N: the normals of its "
                "surfaces do not belong to their contact points",
                contacts[k]->name, c.lambda_N, std::max(std::abs(c.F_N_least), c.F_N_most)));
        if (!contacts[k]->unilateral.enabled && c.F_N_least < -ContactExtremes::rounding(model) &&
            c.F_N_least < -1e-9 * std::abs(c.F_N_most))
            all.push_back(
                fmt::format("contact '{}': the normal force is tensile, up to {:.3g} N; "
                            "with \"unilateral\": true the bodies would separate",
                            contacts[k]->name, -c.F_N_least));
    }
    constexpr double largest_residual = 1e-5;  // [m or rad]
    if (model.keeps_redundant_rows() && !(of.constraint_norm <= largest_residual))
        all.push_back(
            fmt::format("the constraints with redundant rows are violated by up to {:.1e} m or rad; "
                        "reduce the step",
                        of.constraint_norm));
    return all;
}

}  // namespace hilda::run
