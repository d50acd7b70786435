// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/particles/particle_keys.hpp"

#include "granular/reading/clump_keys.hpp"

#include <utility>

namespace hilda::granular {

namespace {

/// Notes the definition of a particle for the schema, with the keys that clumps have as well.
void describe(ObjectReader& o)
{
    o.defines(
        "particle", "Particle",
        "A single particle, or with the key clump a clump. The ids of these particles are their positions in "
        "the list, counted from 0; a clump has as many ids as spheres. Particles of fills follow.",
        R"("if": {"required": ["clump"]}, "then": {"not": {"anyOf": [{"required": ["radius"]}, )"
        R"({"required": ["material"]}, {"required": ["fixed"]}, {"required": ["force"]}, )"
        R"({"required": ["attached_to"]}]}}, "else": {"required": ["radius"], "not": {"required": ["scale"]}})");
    o.note("r", "vector",
           {"Initial position of the centre, or of the centre of mass of the clump [m], in the global frame.",
            "[0, 0, 0.01]"});
    constexpr const char* vector = R"("$ref": "#/$defs/vector", "default": [0, 0, 0])";
    o.note("v", vector, {"Initial velocity [m/s], in the global frame.", "[0, 0, -1]"});
    o.note("omega", vector, {"Initial angular velocity [rad/s], in the global frame.", "[10, 0, 0]"});
    o.note(
        "orientation",
        R"("type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4, "default": [1, 0, 0, 0])",
        {"Initial orientation as Euler parameters e0, e1, e2, e3 [-], from the frame of the particle or of "
         "the template of the clump to the global frame; e0 is the scalar part. The length must be 1 to "
         "within 1e-3. Only of a clump, or with \"orientation\": true in the case.",
         "[0.8, 0, 0, 0.6]"});
}

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
    describe(o);
    if (o.has("clump")) return read_clump_of_world(o, c, keys, adds);
    if (o.has("scale")) o.fail("scale", "scale is only for a particle with clump");
    Particle p{.r = o.vec3("r"),
               .radius = o.positive("radius", {"Radius [m]. Required without clump.", "0.001"}),
               .material = keys.material(o),
               .v = o.vec3("v", {}, Vec3{0, 0, 0}),
               .omega = o.vec3("omega", {}, Vec3{0, 0, 0}),
               .fixed = o.flag("fixed",
                               {"If true, the position is fixed and the particle rotates with the constant "
                                "angular velocity omega.",
                                "true"},
                               false),
               .replica = keys.replica(o),
               .attached_to = EntryKeys::attached_to(o, c)};
    if (o.has("orientation")) {
        if (!options.orientation) o.fail("orientation", "orientation requires /orientation to be true");
        const std::vector<double> e = o.numbers("orientation", 4);
        p.e = {e[0], e[1], e[2], e[3]};
    }
    const double diameter = 2 * p.radius;
    o.note("force", R"("$ref": "#/$defs/vector", "default": [0, 0, 0])",
           {"Constant external force [N], in the global frame.", "[0, 1e-4, 0]"});
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
