// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/entry_keys.hpp"

#include "granular/case/case_file.hpp"
#include "granular/case/pair_keys.hpp"

#include <algorithm>

namespace hilda::granular {

int EntryKeys::material(ObjectReader& o, const std::string& more) const
{
    const std::string about = "Name of a material. It may be omitted if there is only one material." + more;
    const std::string name = o.text("material", {.text = about, .example = R"("glass")", .computed = true},
                                    materials.size() == 1 ? std::optional(materials[0].name) : std::nullopt);
    return material_named(name, materials, [&](const std::string& what) { o.fail("material", what); });
}

void EntryKeys::check_group_name(const ObjectReader& o, const char* key, const std::string& name)
{
    const auto is_forbidden = [](unsigned char c) { return c < ' ' || c == 127 || c == ',' || c == '"'; };
    if (name.empty() || std::any_of(name.begin(), name.end(), is_forbidden))
        o.fail(key,
               "the name of a group must not be empty or contain commas, quotes and control characters, "
               "because it is in tables, got " +
                   io::described(name));
}

int EntryKeys::group(ObjectReader& o)
{
    if (!o.given("group")) return Groups::none;
    const std::string name = o.text("group", {"Name of the group of these particles, for groups.csv, the "
                                              "column group of tables and frames, and remove of stages.",
                                              R"("lid")", R"("minLength": 1, "pattern": "^[^,\"]*$")"});
    check_group_name(o, "group", name);
    return groups.number(name);
}

std::uint16_t EntryKeys::replica(ObjectReader& o) const
{
    constexpr long most = 0xffff;
    const long number = o.count("replica",
                                {"Number of the replica. Replicas are independent systems in one run: "
                                 "particles of different replicas do not interact, and all replicas share "
                                 "the same boundaries. It must be 0 if a boundary has a mass.",
                                 "1", R"("maximum": 65535)"},
                                0);
    if (number > most) o.fail("replica", "replica must be at most 65535, got " + std::to_string(number));
    if (number > 0 && !free.empty())
        o.fail("replica", "replica must be 0 if a boundary has a mass, as " + free + " has, got " +
                              std::to_string(number));
    return static_cast<std::uint16_t>(number);
}

int EntryKeys::attached_to(ObjectReader& o, const Case& c)
{
    o.note(
        "attached_to", "text",
        {"Name of a boundary without a mass. The particles move rigidly with it from the start on, whatever "
         "their contacts: a rough wall, base or drum. Their loads are included in those of the boundary.",
         R"("drum")"});
    if (!o.has("attached_to")) return -1;
    const std::string name = o.one_of("attached_to", c.boundaries);
    const auto at = std::find(c.boundaries.begin(), c.boundaries.end(), name);
    const int number = static_cast<int>(at - c.boundaries.begin());
    if (c.world->all_boundaries()[static_cast<std::size_t>(number)].mass > 0)
        o.fail("attached_to", "attached_to must name a boundary without a mass, got " + io::described(name));
    for (const char* key : {"v", "omega", "random_v"})
        if (o.has(key)) o.fail(key, std::string(key) + " must not be given together with attached_to");
    return number;
}

}  // namespace hilda::granular
