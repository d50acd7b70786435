// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/model_frames.hpp"

#include "dae/model.hpp"

namespace hilda::studies {

ModelFrames::ModelFrames(const dae::Model& model, const lie::TimeGrid& grid)
    : ModelFrames(model, [grid](long n) { return grid.is_row(n); })
{}

ModelFrames::ModelFrames(const dae::Model& model, EvenSelection selected)
    : ModelFrames(model, [selected](long n) mutable { return selected.is_selected(n); })
{}

ModelFrames::ModelFrames(const dae::Model& model, std::function<bool(long)> is_selected)
    : model(model), is_selected(std::move(is_selected)), evolving(evolving_contacts(model))
{
    for (const auto& force : model.forces())
        if (const auto* c = dynamic_cast<const contact::ContactForce*>(force.get())) {
            contacts.push_back(c);
            snapshots.add_surface(c->i, c->contact.i);
            snapshots.add_surface(c->j, c->contact.j);
        }
    for (const contact::EvolvingContact* c : evolving) {
        snapshots.add_surface(c->i, c->shape_i);
        snapshots.add_surface(c->j, c->shape_j);
        force_elements.push_back(find_force_elements(model, *c));
    }
}

void ModelFrames::accepted(const lie::State& x, long n, int)
{
    if (!is_selected(n)) return;
    std::vector<Snapshots::ContactData> contact_data;
    for (size_t k = 0; k < contacts.size(); ++k) {
        const contact::ContactForce& c = *contacts[k];
        if (!c.is_active(x)) continue;
        const contact::ContactForce::Instant now = c.at(x);
        if (now.contact_state.N > 0)
            contact_data.push_back(Snapshots::contact_data(static_cast<int>(k), c.i, now.contact_state,
                                                           c.friction(x), now.history.deflections));
    }
    for (size_t k = 0; k < evolving.size(); ++k) {
        const contact::EvolvingContact& c = *evolving[k];
        if (dae::Model::inactive(c, x)) continue;
        const dae::Constraint::Arguments at = model.arguments(c, x);
        const contact::ContactPoint contact_point = c.contact_point(at);
        const contact::EvolvingContact::Multipliers of = c.multipliers(at, x.lambda);
        Snapshots::ContactData shown{.contact = static_cast<int>(contacts.size() + k),
                                     .i = c.i,
                                     .C = contact_point.C(),
                                     .N = of.F_N * contact_point.n,
                                     .F = of.friction,
                                     .slipping = false,
                                     .rolling = c.velocity_rows() > 0};
        if (const contact::EvolvingFriction* friction = force_elements[k].friction; friction != nullptr) {
            const contact::EvolvingFriction::Instant now = friction->at(x);
            const Snapshots::ContactData by_force = Snapshots::contact_data(
                shown.contact, c.i, now.contact_state, friction->friction(x), now.history.deflections);
            shown.F = by_force.F, shown.slipping = by_force.slipping, shown.rolling = by_force.rolling;
        }
        contact_data.push_back(shown);
    }
    snapshots.add(x.t, x.body, std::move(contact_data));
}

}  // namespace hilda::studies
