// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_list.hpp"

#include "contact/contact_pairs.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"

#include <set>

namespace hilda::contact {

namespace {

using io::Json;

std::string pair_name(const dae::Model& model, const std::string& group, int i, int j)
{
    return group + ": " + model.body_name(i) + '-' + model.body_name(j);
}

/// Reads an element. Its canonical form has one element for each pair of a group.
void read_contact(dae::ObjectReader& entry, const dae::PartialModel& to, std::set<std::string>& used_names,
                  ReadContact read, Json::List& recorded)
{
    dae::Model& model = *to.out.model;
    std::shared_ptr<const void> shared;
    define_contact(entry);
    const std::string entry_name = dae::unique_name(entry, "contact", used_names);
    const ContactPairs all = read_contact_pairs(entry, to.bodies, model.bodies());
    for (const auto& [i, j] : all.pairs) {
        dae::ObjectReader o = entry.again();
        const std::string name = all.is_group ? pair_name(model, entry_name, i, j) : entry_name;
        o.record("name", name);
        for (const auto& [key, number] : {std::pair("body_i", i), std::pair("body_j", j)})
            o.find(key), o.record(key, model.body_name(number));
        for (const char* key : {"name", "bodies"}) o.find(key);
        const ContactPair pair = {.name = name,
                                  .i = i,
                                  .j = j,
                                  .model = model,
                                  .start = to.out.x,
                                  .normal_rows = to.normal_rows,
                                  .changes = to.out.changes,
                                  .surface_i = all.surface_i,
                                  .surface_j = all.surface_j,
                                  .shared = shared};
        o.located([&] {
            try {
                read(o, pair);
            } catch (const io::PlacedError&) {
                throw;
            } catch (const lie::InvalidInput& e) {
                if (!all.is_group) throw;
                throw lie::InvalidInput("contact '" + name + "': " + e.what());
            }
        });
        to.out.force_place.resize(model.forces().size(), o.place());
        to.out.general_place.resize(model.general_constraints().size(), o.place());
        recorded.push_back(o.finish());
    }
}

}  // namespace

void read_contacts(dae::ObjectReader& model, const dae::PartialModel& to, ReadContact read)
{
    model.note("contacts",
               R"("type": "array", "default": [], "items": {"type": "object", "$ref": "#/$defs/contact"})",
               {"Contacts between surfaces of two bodies.",
                R"([{"body_i": "ball", "body_j": "ground", "surface_i": {"type": "sphere", "radius": 0.1}, )"
                R"("surface_j": {"type": "plane"}, "normal": {"type": "hooke", "stiffness": 1e5}}])"});
    const Json::List& list = model.list("contacts", false);
    if (list.empty()) return;
    std::set<std::string> used_names;
    Json::List recorded;
    for (std::size_t k = 0; k < list.size(); ++k) {
        dae::ObjectReader entry(to.source, list[k], io::pointer_to("/contacts", std::to_string(k)));
        read_contact(entry, to, used_names, read, recorded);
    }
    model.record("contacts", std::move(recorded));
}

}  // namespace hilda::contact
