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
        const dae::Constraint::Size size = c->size();
        const int rows =
            size.position_rows - size.algebraic_variables + size.velocity_rows - 2 * size.bounded_pairs;
        if (dynamic_cast<const contact::EvolvingContact*>(c.get()) == nullptr)
            ++count.others, count.of_others += rows;
        else if (!dae::Model::inactive(*c, x))
            count.of_contacts += rows;
    }
    return count;
}

}  // namespace hilda::run
