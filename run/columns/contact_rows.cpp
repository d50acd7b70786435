// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/columns/contact_rows.hpp"

#include "dae/model.hpp"

namespace hilda::run {

std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model)
{
    std::vector<const contact::EvolvingContact*> all;
    for (const auto& c : model.general_constraints())
        if (const auto* contact = dynamic_cast<const contact::EvolvingContact*>(c.get()))
            all.push_back(contact);
    return all;
}

contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x)
{
    if (dae::Model::inactive(c, x)) return {};
    return c.multipliers(model.arguments(c, x), x.lambda);
}

RowsOfGeneralConstraints rows_of_general_constraints(const dae::Model& model, const lie::State& x)
{
    RowsOfGeneralConstraints count;
    for (const auto& c : model.general_constraints()) {
        const int rows =
            c->position_rows() - c->algebraic_variables() + (c->is_regularised() ? 0 : c->velocity_rows());
        if (dynamic_cast<const contact::EvolvingContact*>(c.get()) == nullptr)
            ++count.others, count.of_others += rows;
        else if (!dae::Model::inactive(*c, x))
            count.of_contacts += rows;
    }
    return count;
}

}  // namespace hilda::run
