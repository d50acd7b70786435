// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/reading/clump_keys.hpp"

#include "granular/reading/inertia_keys.hpp"
#include "io/error.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// The number of the template that the key clump names
int template_of(ObjectReader& o, const World& world)
{
    std::vector<std::string> names;
    for (const ClumpTemplate& t : world.clump_templates()) names.push_back(t.name);
    if (names.empty())
        o.fail("clump", "clump must name an entry of clumps, which the case does not have, got " +
                            io::described(*o.find("clump")));
    const std::string name = o.one_of("clump", names);
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
}

void refuse_with_clump(const ObjectReader& o, std::initializer_list<const char*> keys)
{
    for (const char* key : keys)
        if (o.has(key)) o.fail(key, std::string(key) + " must not be given together with clump");
}

std::array<double, 4> read_orientation(ObjectReader& o)
{
    const std::vector<double> e = o.numbers("orientation", 4);
    const double length = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    if (!(std::abs(length - 1) < 1e-3))
        o.fail("orientation",
               "Euler parameters must have the length 1 within 1e-3, got " + io::shortest(length));
    return {e[0], e[1], e[2], e[3]};
}

}  // namespace

ClumpTemplate read_clump(ObjectReader& o, const World& world, int material, const Material& properties)
{
    const std::string name = o.name(
        "name",
        {.text = "Name, by which particles and fills refer to the template. By default clump 0, clump 1, ...",
         .example = R"("pair")",
         .computed = true},
        "clump " + std::to_string(world.clump_templates().size()));
    for (const ClumpTemplate& other : world.clump_templates())
        if (other.name == name) o.fail("name", "two clumps have the same name, got " + io::described(name));
    std::vector<Sphere> spheres;
    for (ObjectReader& s : o.objects("spheres", "clump_sphere",
                                     {"The spheres, at most 256.",
                                      R"([{"r": [5e-4, 0, 0], "radius": 1e-3}, )"
                                      R"({"r": [-5e-4, 0, 0], "radius": 1e-3}])",
                                      R"("maxItems": 256)"},
                                     true)) {
        s.defines("clump_sphere", "Sphere of a clump", "A sphere of a template.");
        const Vec3 r =
            s.vec3("r", {"Centre [m], in the frame of the template.", "[5e-4, 0, 0]"}, Vec3{0, 0, 0});
        spheres.push_back({r, s.positive("radius", {"Radius [m].", "0.001"})});
        s.finish();
    }
    if (spheres.empty()) o.fail("spheres", "a clump must have at least one sphere, got none");
    o.exclude("density", "mass");
    o.note("mass", "positive", {"Mass [kg], instead of density; together with inertia.", "1.5e-5"});
    o.note("inertia", R"("$ref": "#/$defs/inertia")",
           {"Inertia about the centre of mass [kg m^2], in the frame of the template: one moment for every "
            "axis, the three principal moments if the axes of the frame are principal axes, or the symmetric "
            "matrix by rows. The principal moments must satisfy the triangle inequality. Only with mass.",
            "[6e-12, 1e-11, 1e-11]"});
    o.note("centre", "vector",
           {"Centre of mass [m], in the frame of the template. By default that of the union of the spheres. "
            "Only with mass.",
            "[0, 0, 1e-4]"});
    if (!o.has("mass")) {
        for (const char* key : {"inertia", "centre"})
            if (o.has(key)) o.fail(key, std::string(key) + " needs mass, got none");
        const double density = o.positive(
            "density",
            {.text = "Density of the union of the spheres [kg/m^3]. By default that of the material.",
             .example = "2500",
             .computed = true},
            properties.density);
        return o.located([&] { return solid_clump(name, spheres, density, material); });
    }
    ClumpTemplate t = o.located([&] { return solid_clump(name, spheres, 1, material); });
    t.mass = o.positive("mass");
    if (!o.has("inertia")) o.fail("inertia is required together with mass");
    t.inertia = read_inertia(o);
    if (t.inertia.is_zero()) o.fail("inertia", "inertia must be positive, got 0");
    t.centre = o.vec3("centre", {}, t.centre);
    return t;
}

Clump read_single_clump(ObjectReader& o, const World& world, std::uint16_t replica)
{
    refuse_with_clump(o, {"radius", "material", "fixed", "attached_to", "force"});
    o.note("clump", "text",
           {"Name of an entry of clumps: the entry is a clump with its spheres and material. Not together "
            "with radius, material, fixed, force and attached_to.",
            R"("pair")"});
    Clump c{.shape = template_of(o, world),
            .r = o.vec3("r"),
            .v = o.vec3("v", {}, Vec3{0, 0, 0}),
            .omega = o.vec3("omega", {}, Vec3{0, 0, 0}),
            .scale = o.positive(
                "scale",
                {"Factor of the lengths of the clump, at the same density [-]. Only with clump.", "0.9"}, 1),
            .replica = replica};
    if (o.has("orientation")) c.e = read_orientation(o);
    return c;
}

void note_clumps(ObjectReader& o, const char* about_clump)
{
    o.note("clump", "text", {about_clump, R"("pair")"});
    o.note("orientation", R"("type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4)",
           {"Orientation of all clumps as Euler parameters e0, e1, e2, e3 [-], from the frame of the "
            "template to the global frame. By default each clump has a random orientation. Only with clump.",
            "[1, 0, 0, 0]"});
}

PlacedClumps read_placed_clumps(ObjectReader& o, const World& world)
{
    PlacedClumps f;
    if (!o.has("clump")) {
        if (o.has("orientation")) o.fail("orientation", "orientation requires the key clump");
        return f;
    }
    refuse_with_clump(o, {"material", "attached_to"});
    f.shape = template_of(o, world);
    f.of = world.clump_templates()[static_cast<std::size_t>(f.shape)];
    f.radius = f.of.bounding_radius();
    if (o.has("orientation")) f.orientation = read_orientation(o);
    return f;
}

Clump PlacedClumps::at(const Particle& place, Random& random) const
{
    Clump c{
        .shape = shape, .r = place.r, .v = place.v, .scale = place.radius / radius, .replica = place.replica};
    if (orientation) {
        c.e = *orientation;
        return c;
    }
    // uniformly distributed rotations (Shoemake 1992)
    const double u = random.number(), a = random.number(0, 2 * M_PI), b = random.number(0, 2 * M_PI),
                 s = std::sqrt(1 - u), t = std::sqrt(u);
    c.e = {s * std::sin(a), s * std::cos(a), t * std::sin(b), t * std::cos(b)};
    return c;
}

}  // namespace hilda::granular
