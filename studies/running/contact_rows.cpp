// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/contact_rows.hpp"

#include <algorithm>

namespace hilda::studies {

std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model)
{
    std::vector<const contact::EvolvingContact*> all;
    for (const auto& c : model.evolving())
        if (const auto* contact = dynamic_cast<const contact::EvolvingContact*>(c.get()))
            all.push_back(contact);
    return all;
}

contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x)
{
    if (dae::Model::inactive(c, x)) return {};
    return c.multipliers(model.at(c, x), x.lambda);
}

ContactForces forces_of(const dae::Model& model, const contact::EvolvingContact& c)
{
    ContactForces of;
    for (const auto& force : model.forces()) {
        const auto* tracked = dynamic_cast<const contact::TrackedForce*>(force.get());
        if (tracked == nullptr || tracked->held_by() != &c) continue;
        if (const auto* friction = dynamic_cast<const contact::EvolvingFriction*>(tracked))
            of.friction = friction;
        else
            of.fallback = dynamic_cast<const contact::ContactForce*>(tracked);
    }
    return of;
}

OnBodyI on_body_i(const dae::Model& model, const contact::EvolvingContact& c, const ContactForces& of,
                  const lie::State& x)
{
    if (of.fallback != nullptr && of.fallback->works(x))
        return {.F_N = std::max(0., of.fallback->at(x).contact_state.N),
                .friction = of.fallback->friction(x).F};
    const contact::EvolvingContact::Multipliers m = forces(model, c, x);
    return {.F_N = m.F_N, .friction = of.friction != nullptr ? of.friction->friction(x).F : m.friction};
}

int contact_rank(const dae::Model& model, const lie::State& x)
{
    int rank = 0;
    for (const auto& c : model.evolving())
        if (!dae::Model::inactive(*c, x)) rank += c->rows() + c->velocity_rows() - c->unknowns();
    return rank;
}

}  // namespace hilda::studies
