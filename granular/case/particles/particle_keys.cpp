// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/particles/particle_keys.hpp"

#include "granular/reading/clump_keys.hpp"

#include <utility>

namespace hilda::granular {

namespace {

double read_clump_of_world(ObjectReader& o, Case& c, EntryKeys& keys, bool adds)
{
    const Clump clump = read_single_clump(o, *c.world, keys.replica(o));
    const ClumpTemplate& t = c.world->clump_templates()[static_cast<std::size_t>(clump.shape)];
    const double diameter = 2 * clump.scale * t.bounding_radius();
    const int group = keys.group(o);
    o.finish();
    if (!adds) return diameter;
    const std::uint32_t id = o.located([&] { return c.world->add_clump(clump); });
    keys.groups.add(id, group);
    c.entries.emplace_back(id, o.pointer());
    return diameter;
}

}  // namespace

double read_particle(ObjectReader& o, Case& c, EntryKeys& keys, const WorldOptions& options, bool adds)
{
    if (o.has("clump")) return read_clump_of_world(o, c, keys, adds);
    if (o.has("scale")) o.fail("scale", "scale is only for a particle with clump");
    Particle p{.r = o.vec3("r"),
               .radius = o.positive("radius"),
               .material = keys.material(o),
               .v = o.vec3("v", Vec3{0, 0, 0}),
               .omega = o.vec3("omega", Vec3{0, 0, 0}),
               .fixed = o.flag("fixed", {}, false),
               .replica = keys.replica(o),
               .attached_to = EntryKeys::attached_to(o, c)};
    if (o.has("orientation")) {
        if (!options.orientation) o.fail("orientation", "orientation requires /orientation to be true");
        const std::vector<double> e = o.numbers("orientation", 4);
        p.e = {e[0], e[1], e[2], e[3]};
    }
    const double diameter = 2 * p.radius;
    const std::optional<Vec3> force = o.has("force") ? std::optional(o.vec3("force")) : std::nullopt;
    const int group = keys.group(o);
    o.finish();
    if (p.fixed && !keys.free.empty() && !std::exchange(keys.has_fixed, true))
        c.notices.push_back(o.place("fixed") +
                            ": a fixed particle does not touch boundaries, also if they have a mass as " +
                            keys.free + " has; particles that shall carry it must be free to move");
    if (!adds) return diameter;
    const std::uint32_t id = o.located([&] { return c.world->add(p); });
    keys.groups.add(id, group);
    c.entries.emplace_back(id, o.pointer());
    if (force) c.world->set_force(id, *force);
    return diameter;
}

}  // namespace hilda::granular
