// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/selection.hpp"

#include "granular/world/groups.hpp"
#include "granular/world/world.hpp"
#include "io/schema/type_schema.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace hilda::granular {

bool CutRegion::contains(const Vec3& x) const
{
    const Vec3 d = x - r;
    const double along = d.dot(axis);
    switch (shape) {
        case Shape::everywhere:
            return true;
        case Shape::box:
            return low.x <= x.x && x.x <= high.x && low.y <= x.y && x.y <= high.y && low.z <= x.z &&
                   x.z <= high.z;
        case Shape::cylinder:
            return 0 <= along && along <= length && (d - along * axis).norm() <= radius;
        case Shape::half_space:
            return along >= 0;
    }
    return false;
}

Selection read_selection(ObjectReader o)
{
    Selection s;
    CutRegion& region = s.region;
    const std::string type = o.one_of("type", {"box", "cylinder", "half_space"});
    io::defines_type(
        o, {"Cut", "type", "Type of the region."}, "cut_" + type, type,
        {.description = type == "box"        ? "A box along the axes."
                        : type == "cylinder" ? "A cylinder between two planes perpendicular to its axis."
                                             : "All points on one side of a plane.",
         .examples = {}});
    if (type == "box") {
        region.shape = CutRegion::Shape::box;
        region.low = o.vec3("low", {"Lower corner [m], in the global frame.", "[0, 0, 0.03]"});
        region.high = o.vec3("high", {"Upper corner [m], in the global frame.", "[0.03, 0.02, 0.1]"});
        for (const auto& [low, high, axis] : {std::tuple{region.low.x, region.high.x, 0u},
                                              {region.low.y, region.high.y, 1u},
                                              {region.low.z, region.high.z, 2u}})
            if (!(high > low))
                o.fail("high", axis,
                       "high must be above low, " + io::shortest(low) + ", got " + io::shortest(high));
    } else {
        const bool is_cylinder = type == "cylinder";
        region.shape = is_cylinder ? CutRegion::Shape::cylinder : CutRegion::Shape::half_space;
        region.r = o.vec3("r", {is_cylinder ? "Centre of its base [m], in the global frame."
                                            : "A point of the plane [m], in the global frame.",
                                "[0, 0, 0.03]"});
        region.axis =
            is_cylinder
                ? o.direction("axis", {"Direction from the base to the other end, in the global frame [-].",
                                       "[0, 0, 1]"})
                : o.direction("normal", {"Normal of the plane into the half-space whose particles are "
                                         "removed, in the global frame [-].",
                                         "[0, 0, 1]"});
        if (is_cylinder) {
            region.radius = o.positive("radius", {"Radius of the cylinder [m].", "0.01"});
            region.length = o.positive("length", {"Length along the axis [m].", "0.1"});
        }
    }
    o.note("group", "name",
           {"Only the particles of this group are removed. By default those of all groups and of none.",
            R"("bed")"});
    if (o.find("group") != nullptr) s.group = o.name("group");
    o.finish();
    return s;
}

std::vector<std::uint32_t> selected(const World& w, const Groups* groups,
                                    const std::vector<Selection>& selections)
{
    const auto is_selected = [&](std::uint32_t id, const Vec3& x) {
        const int number = groups != nullptr ? groups->of(id) : Groups::none;
        const auto contains = [&](const Selection& s) {
            return (s.group.empty() ||
                    (number != Groups::none && groups->names[static_cast<std::size_t>(number)] == s.group)) &&
                   s.region.contains(x);
        };
        return std::any_of(selections.begin(), selections.end(), contains);
    };
    std::set<std::uint32_t> clumps;  // first ids
    for (const Clump& c : w.clumps())
        if (is_selected(c.id, c.r)) clumps.insert(c.id);
    std::vector<std::uint32_t> ids;
    w.each_particle([&](const Particle& p) {
        const bool is_in =
            p.clump < 0 ? is_selected(p.id, p.r) : clumps.count(static_cast<std::uint32_t>(p.clump)) > 0;
        if (is_in) ids.push_back(p.id);
    });
    return ids;
}

}  // namespace hilda::granular
