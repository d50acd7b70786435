// SPDX-License-Identifier: GPL-3.0-or-later
/// contact-points.csv: the points of all rigid contacts that have a force, a line each, at the output rows.

#include "contact/rigid/rigid_contacts.hpp"
#include "dae/model.hpp"
#include "io/message.hpp"
#include "run/tables/sink.hpp"

namespace hilda::run {

namespace {

using lie::Vec3;

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
                const std::string name = contacts->name_of_pair(pair);
                for (const contact::RigidPoint& p : points) {
                    if (!(p.N > 0)) continue;
                    text += io::formatted("%.12g,%s,%u", node.x.t, name.c_str(), p.feature);
                    const Vec3 C = p.at.C();
                    for (const Vec3& v : {C, p.at.n})
                        for (const double component : v) text += io::formatted(",%.12g", component);
                    text += io::formatted(",%.9g,%.12g", p.at.gap, p.N);
                    for (const double component : p.F) text += io::formatted(",%.12g", component);
                    text += p.slips ? ",1\n" : ",0\n";
                }
            });
        }
    }

    const dae::Model& model;
    std::vector<contact::RigidPoint> points;
};

const bool registered = io::Registry<SinkType>::add(
    {.name = "contact-points",
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--contacts") || run.model.rigid_contacts().empty()) return nullptr;
         return std::make_unique<ContactPoints>(run);
     },
     .files = {"contact-points.csv"}});

}  // namespace

}  // namespace hilda::run
