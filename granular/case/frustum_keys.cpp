// SPDX-License-Identifier: GPL-3.0-or-later
// Finite surfaces of revolution as boundaries: frusta, also as cylinders and cones with a length, disks and
// tori.
#include "granular/case/boundary_keys.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

/// The open ends of a frustum: "-" at r, "+" at r + length axis
std::array<bool, 2> read_open_ends(ObjectReader& o)
{
    o.note("open", R"("type": "array", "items": {"enum": ["-", "+"]}, "uniqueItems": true, "default": [])",
           {"Ends without an end face: - at r, + at r + length axis. With a length. With inside, the end "
            "faces are boundaries of their own, NAME- and NAME+, and parts of this one.",
            R"(["+"])"});
    std::array<bool, 2> open{};
    const io::Json::List& all = o.list("open", false);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::string* const name = all[k].string();
        const std::size_t end = name != nullptr && *name == "-" ? 0 : name != nullptr && *name == "+" ? 1 : 2;
        if (end == 2 || std::exchange(open[end], true))
            o.fail("open", k, "open must list some of -, +, each once, got " + io::described(all[k]));
    }
    return open;
}

/// Disk at an end of a frustum with the particles inside. It has no edge, because the side begins there.
NamedBoundary end_face(const NamedBoundary& side, bool second)
{
    const Boundary& b = side.boundary;
    NamedBoundary end{.name = side.name + (second ? '+' : '-'), .boundary = {}};
    end.motion.name = end.name, end.part_of = side.name;
    end.boundary.shape = Boundary::Shape::disk, end.boundary.flags = without_edge;
    end.boundary.radius = second ? b.second_radius : b.radius;
    end.boundary.r = b.r + (second ? b.to : b.from) * b.axis;
    end.boundary.axis = second ? -b.axis : b.axis;
    return end;
}

/// Places the centre of mass: r is the centre, and the frustum begins before it.
void set_frustum_centre(NamedBoundary& b, double along)
{
    displace(b, along * b.boundary.axis);
    b.boundary.from -= along, b.boundary.to -= along;
}

std::vector<NamedBoundary> read_frustum_type(ObjectReader& o, NamedBoundary b)
{
    b.boundary.axis = o.direction(
        "axis", {"Direction from the first to the second end [-], in the global frame.", "[0, 0, 1]"});
    const std::vector<double> radii =
        o.numbers("radii", 2,
                  {"Radii at the first and at the second end [m]; one of them may be 0.", "[0.01, 0.05]",
                   R"("items": {"type": "number", "minimum": 0})"});
    for (const double R : radii)
        if (!(R >= 0)) o.fail("radii", "radii must not be negative, got " + io::shortest(R));
    if (!(radii[0] > 0 || radii[1] > 0)) o.fail("radii", "one of the radii must be positive, got 0 and 0");
    return read_frustum(o, b, radii[0], radii[1]);
}

std::vector<NamedBoundary> read_disk(ObjectReader& o, NamedBoundary disk)
{
    Boundary& b = disk.boundary;
    b.shape = Boundary::Shape::disk;
    b.axis = o.direction("normal", {"Normal towards the particles [-], in the global frame.", "[0, 0, 1]"});
    b.radius = o.positive("radius", about_radius);
    const io::About about = {"If true, particles are in contact with both sides.", "true"};
    b.flags = o.flag("two_sided", about, false) ? two_sided_surface : 0;
    read_body(o, disk);
    return {disk};
}

std::vector<NamedBoundary> read_torus(ObjectReader& o, NamedBoundary torus)
{
    Boundary& b = torus.boundary;
    b.shape = Boundary::Shape::torus;
    b.axis = o.direction("axis", {"Direction of the axis [-], in the global frame.", "[0, 1, 0]"});
    b.radius = o.positive("radius", {"Radius of the tube [m].", "0.02"});
    b.second_radius = o.positive(
        "ring_radius", {"Radius of the centre line of the tube [m]; above the radius of the tube.", "0.1"});
    if (!(b.second_radius > b.radius))
        o.fail("ring_radius", "ring_radius must be above radius, " + io::shortest(b.radius) + ", got " +
                                  io::shortest(b.second_radius));
    b.inside =
        o.flag("inside",
               {"If true, the particles are inside of the tube; otherwise they are outside.", "true"}, false);
    if (b.inside != 0 && o.has("density"))
        o.fail("density", "density needs particles outside of the torus, got inside true");
    read_body(o, torus,
              read_density(o, solid_torus(1, b.axis, b.radius, b.second_radius),
                           {"Density of the solid, instead of mass [kg/m^3]. Mass and inertia are those of "
                            "the solid; inertia replaces the latter.",
                            "1200"}));
    return {torus};
}

const bool registered_frustum_keys =
    io::Registry<BoundaryType>::add(
        {"frustum",
         {.description = "Part of a cone between two planes normal to its axis, or finite cylinder, with "
                         "closed or open ends.",
          .examples = {R"("name": "hopper", "axis": [0, 0, 1], "radii": [0.01, 0.05], "length": 0.06,
                          "inside": true, "open": ["-", "+"])"}},
         place_of("The centre of the first end"),
         read_frustum_type}) &&
    io::Registry<BoundaryType>::add(
        {"disk",
         {.description =
              "Disk with a circular edge. The particles are on the side to which the normal points.",
          .examples = {R"("name": "piston", "normal": [0, 0, -1], "radius": 0.02, "r": [0, 0, 0.1])"}},
         place_of("The centre"),
         read_disk}) &&
    io::Registry<BoundaryType>::add(
        {"torus",
         {.description = "Ring torus, for example a tyre.",
          .examples = {R"("name": "tyre", "axis": [0, 1, 0], "radius": 0.02, "ring_radius": 0.1,
                          "r": [0, 0, 0.12])"}},
         place_of("The centre"),
         read_torus});

}  // namespace

std::vector<NamedBoundary> read_frustum(ObjectReader& o, NamedBoundary of, double radius,
                                        double second_radius)
{
    Boundary& b = of.boundary;
    const double length = o.positive("length", {"Length along the axis [m].", "0.1"});
    const Boundary shape = frustum(b.r, b.axis, length, radius, second_radius);
    b.shape = shape.shape, b.radius = radius, b.second_radius = second_radius;
    b.from = 0, b.to = length, b.cosine = shape.cosine, b.sine = shape.sine;
    b.inside = o.flag("inside", about_inside, false);
    const std::array<bool, 2> open = read_open_ends(o);
    const bool two_sided = o.flag(
        "two_sided",
        {"If true, particles are in contact with both sides of the surface. Both ends must be open.", "true"},
        false);
    if (two_sided && (b.inside != 0 || !(open[0] && open[1])))
        o.fail("two_sided", "two_sided needs both ends in open, and not inside, got true");
    b.flags = (two_sided ? two_sided_surface : 0) | (open[0] ? open_first_end : 0) |
              (open[1] ? open_second_end : 0);

    const SolidBody solid = solid_frustum(1, b.axis, length, radius, second_radius);
    if (o.has("density") && (b.inside != 0 || open[0] || open[1]))
        o.fail("density", "density needs closed ends and particles outside, got " +
                              std::string(b.inside != 0 ? "inside true" : "an open end"));
    const std::optional<SolidBody> dense = read_density(
        o, solid,
        {"Density of the solid, instead of mass [kg/m^3]; with closed ends and the particles outside. Mass, "
         "centre of mass and inertia are those of the solid; inertia and centre replace the last two.",
         "7800"});
    read_body(o, of, dense);
    const double middle = solid.centre.dot(b.axis);
    if (b.mass > 0)
        set_frustum_centre(
            of, o.number("centre",
                         {.text = "Centre of mass of a boundary with a mass: its distance from r along the "
                                  "axis [m]. The default is the centre of the homogeneous solid. Position "
                                  "and loads in the output refer to it.",
                          .example = "0.05",
                          .computed = true},
                         middle));
    else if (of.solid)
        set_frustum_centre(of, middle);
    std::vector<NamedBoundary> all = {of};
    if (b.inside == 0) return all;
    if (!open[0] && radius > 0) all.push_back(end_face(of, false));
    if (!open[1] && second_radius > 0) all.push_back(end_face(of, true));
    return all;
}

}  // namespace hilda::granular
