// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/frames/model_frames.hpp"

#include "dae/constraints/d.hpp"
#include "dae/model.hpp"
#include "studies/running/frames/body_drawing.hpp"

namespace hilda::studies {

namespace {

void add_bodies(const dae::Model& model, const ContactOutputs& contacts, Snapshots& to)
{
    std::vector<bool> has_surface(model.all_bodies().size());
    const auto add = [&](int body, const contact::Shape& shape) {
        to.add_surface(body, shape);
        if (body >= 0 && !shape.surface->is_unbounded()) has_surface[body] = true;
    };
    for (const ContactOutputs::Contact& c : contacts.contacts) add(c.i, c.shape_i), add(c.j, c.shape_j);
    for (size_t b = 0; b < has_surface.size(); ++b)
        if (!has_surface[b]) to.add_solid(static_cast<int>(b), body_drawing(model.all_bodies()[b]));
}

void add_joints(const dae::Model& model, Snapshots& to)
{
    const auto add = [&](const dae::Constraint& c) {
        const std::optional<dae::PointPair> points = c.points();
        if (!points) return;
        to.add_joint(points->i, points->s_bar_i);
        to.add_joint(points->j, points->s_bar_j);
        if (dynamic_cast<const dae::D*>(&c) != nullptr) to.add_line(*points, Snapshots::link);
    };
    for (const dae::Model::Row& row : model.all_rows()) add(*row.block);
    for (const auto& constraint : model.general_constraints()) add(*constraint);
}

}  // namespace

ModelFrames::ModelFrames(const dae::Model& model, const lie::TimeGrid& grid)
    : ModelFrames(model, [grid](long n) { return grid.is_row(n); })
{}

ModelFrames::ModelFrames(const dae::Model& model, EvenSelection selected)
    : ModelFrames(model, [selected](long n) mutable { return selected.is_selected(n); })
{}

ModelFrames::ModelFrames(const dae::Model& model, std::function<bool(long)> is_selected)
    : is_selected(std::move(is_selected)), contacts(model)
{
    add_bodies(model, contacts, snapshots);
    add_joints(model, snapshots);
    for (const auto& force : model.forces())
        if (const std::optional<dae::PointPair> points = force->points())
            snapshots.add_line(*points, Snapshots::spring);
}

void ModelFrames::accepted(const lie::State& x, long n, int)
{
    if (!is_selected(n)) return;
    std::vector<Snapshots::ContactData> contact_data;
    for (size_t k = 0; k < contacts.contacts.size(); ++k) {
        const ContactOutput now = contacts.at(k, x);
        if (!now.is_touching) continue;
        contact_data.push_back({.contact = static_cast<int>(k),
                                .i = contacts.contacts[k].i,
                                .C = now.C,
                                .N = now.F_N * now.n,
                                .F = now.F,
                                .slipping = now.slipping,
                                .rolling = now.rolling});
    }
    snapshots.add(x.t, x.body, std::move(contact_data));
}

}  // namespace hilda::studies
