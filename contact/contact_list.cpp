// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_list.hpp"

#include "contact/contact_pairs.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"

#include <set>

namespace hilda::contact {

namespace {

using io::Json;

/// Reads an element. Its canonical form has one element for each pair of a group that is read pair by pair.
void read_contact(dae::ObjectReader& entry, const dae::PartialModel& to, std::set<std::string>& used_names,
                  ReadContact read, Json::List& recorded)
{
    dae::Model& model = *to.out.model;
    std::shared_ptr<const void> shared;
    define_contact(entry);
    const std::string entry_name = dae::unique_name(entry, "contact", used_names);
    const ContactPairs all = read_contact_pairs(entry, to.bodies, model.bodies());

    /// Reads the contact of a pair, or of all pairs with the keys that are given. Returns whether it is read.
    const auto read_pair = [&](int number, bool as_group) {
        const auto [i, j] = all.pair(number);
        dae::ObjectReader o = entry.again();
        const std::string name =
            all.is_group ? ContactPairs::name_of_pair(model, entry_name, i, j) : entry_name;
        o.find("name");
        o.record("name", as_group ? entry_name : name);
        for (const auto& [key, body] : {std::pair("body_i", i), std::pair("body_j", j)}) {
            const Json* given = o.find(key);
            if (!as_group)
                o.record(key, model.body_name(body));
            else if (given != nullptr)
                o.record(key, *given);
        }
        if (const Json* given = o.find("bodies"); given != nullptr && as_group) o.record("bodies", *given);
        const ContactPair pair = {.name = name,
                                  .i = i,
                                  .j = j,
                                  .model = model,
                                  .start = to.out.x,
                                  .normal_rows = to.normal_rows,
                                  .changes = to.out.changes,
                                  .surface_i = all.surface_i,
                                  .surface_j = all.surface_j,
                                  .shared = shared,
                                  .group = as_group ? &all : nullptr,
                                  .group_name = entry_name};
        const std::size_t groups_before = model.near_forces().all_groups().size();
        bool has_group = false;
        o.located([&] {
            try {
                has_group = read(o, pair);
            } catch (const io::PlacedError&) {
                throw;
            } catch (const lie::InvalidInput& e) {
                if (!all.is_group) throw;
                throw lie::InvalidInput("contact '" + name + "': " + e.what());
            }
        });
        if (as_group && !has_group) return false;
        to.out.force_place.resize(model.forces().size(), o.place());
        to.out.general_place.resize(model.general_constraints().size(), o.place());
        const auto& groups = model.near_forces().all_groups();
        if (groups.size() > groups_before) groups.back()->place = o.place();
        recorded.push_back(o.finish());
        return true;
    };

    if (all.is_group && all.count() > most_single_pairs && read_pair(all.first_number(), true)) return;
    if (all.count() > ContactPairs::most_listed)
        entry.fail(all.each_two ? "bodies" : "body_i", "a group of contacts of this type may have at most " +
                                                           std::to_string(ContactPairs::most_listed) +
                                                           " pairs of bodies, got " +
                                                           std::to_string(all.count()));
    for (int number = 0; number < all.numbers(); ++number)
        if (all.has(number)) read_pair(number, false);
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
