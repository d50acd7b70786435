// SPDX-License-Identifier: GPL-3.0-or-later
/// contact-points.csv: the points of all contacts with several contact points that have a force, a line each,
/// at the output rows.

#include "contact/compliant/manifold_force.hpp"
#include "contact/rigid/rigid_contacts.hpp"
#include "dae/model.hpp"
#include "io/message.hpp"
#include "run/tables/sink.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

using lie::Vec3;

bool has_several_points(const dae::Model& model)
{
    const auto is_manifold = [](const dae::Force& force) {
        return dynamic_cast<const contact::ManifoldForce*>(&force) != nullptr;
    };
    const auto& groups = model.near_forces().all_groups();
    return !model.rigid_contacts().empty() ||
           std::any_of(model.forces().begin(), model.forces().end(),
                       [&](const auto& force) { return is_manifold(*force); }) ||
           std::any_of(groups.begin(), groups.end(),
                       [&](const auto& group) { return is_manifold(group->example()); });
}

class ContactPoints final : public RowsSink {
public:
    explicit ContactPoints(const RunSetup& run)
        : RowsSink(run.directory, "contact-points.csv"), model(run.model)
    {}

private:
    std::string header() const override
    {
        return "t,contact,point,Cx,Cy,Cz,nx,ny,nz,gap,N,Ff_x,Ff_y,Ff_z,slipping\n";
    }

    void append(std::string& text, const RunNode& node) override
    {
        if (!node.is_row) return;
        for (const auto& rigid : model.rigid_contacts()) {
            const auto* contacts = dynamic_cast<const contact::RigidContacts*>(rigid.get());
            if (contacts == nullptr) continue;
            contacts->for_touching_pairs(node.x, [&](int pair) {
                contacts->points(node.x, pair, points);
                append_points(contacts->name_of_pair(pair), node.x.t, text);
            });
        }
        model.for_forces(node.x, [&](const dae::Force& force, int) {
            const auto* contact = dynamic_cast<const contact::ManifoldForce*>(&force);
            if (contact == nullptr) return;
            contact->points(node.x, points);
            append_points(contact->name, node.x.t, text);
        });
    }

    void append_points(const std::string& name, double t, std::string& text) const
    {
        for (const contact::LoadedPoint& p : points) {
            if (!(p.N > 0)) continue;
            text += io::formatted("%.12g,%s,%u", t, name.c_str(), p.feature);
            const Vec3 C = p.at.C();
            for (const Vec3& v : {C, p.at.n})
                for (const double component : v) text += io::formatted(",%.12g", component);
            text += io::formatted(",%.9g,%.12g", p.at.gap, p.N);
            for (const double component : p.F) text += io::formatted(",%.12g", component);
            text += p.slips ? ",1\n" : ",0\n";
        }
    }

    const dae::Model& model;
    std::vector<contact::LoadedPoint> points;
};

const bool registered = io::Registry<SinkType>::add(
    {.name = "contact-points",
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--contacts") || !has_several_points(run.model)) return nullptr;
         return std::make_unique<ContactPoints>(run);
     },
     .files = {"contact-points.csv"}});

}  // namespace

}  // namespace hilda::run
