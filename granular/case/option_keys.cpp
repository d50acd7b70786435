// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/option_keys.hpp"

#include "granular/case/continued_case.hpp"

#include <algorithm>
#include <tuple>

namespace hilda::granular {

namespace {

Scheme read_scheme(ObjectReader& o)
{
    const std::vector<std::string> names(std::begin(scheme_names), std::end(scheme_names));
    const std::string name = o.one_of("integrator", names,
                                      {"Time integration scheme: symplectic (semi-implicit) Euler, velocity "
                                       "Verlet, forward Euler, forward Euler with a second-order Taylor term "
                                       "in the positions, or the explicit scheme of Chung and Lee (1994).",
                                       R"("velocity-verlet")"},
                                      names[0]);
    return static_cast<Scheme>(std::find(names.begin(), names.end(), name) - names.begin());
}

void read_domain(ObjectReader domain, WorldOptions& o)
{
    domain.defines("domain", "Domain",
                   "Box that contains all particles. A particle that leaves it stops the run with an error, "
                   "unless outflow or lost says otherwise.");
    o.low = domain.vec3("low", {"Lower corner [m], in the global frame.", "[-0.01, -0.01, -0.01]"});
    o.high = domain.vec3(
        "high", {"Upper corner [m], in the global frame. It must exceed the lower corner in each component.",
                 "[0.05, 0.05, 0.1]"});
    for (const auto& [low, high, axis] :
         {std::tuple{o.low.x, o.high.x, 0u}, {o.low.y, o.high.y, 1u}, {o.low.z, o.high.z, 2u}})
        if (!(low < high))
            domain.fail("high", axis,
                        "high must be above low, " + io::shortest(low) + ", got " + io::shortest(high));
    o.periodic = domain.flags("periodic",
                              {"Periodicity along x, y and z. In a periodic direction a particle that leaves "
                               "at one end enters at the other.",
                               "[true, true, false]"},
                              o.periodic);
    o.outflow = domain.sides("outflow", {"Sides through which particles leave: they are removed and recorded "
                                         "in outflow.csv. A periodic axis has no sides.",
                                         R"(["-z"])"});
    for (std::size_t side = 0; side < o.outflow.size(); ++side)
        if (o.outflow[side] && o.periodic[side / 2])
            domain.fail("outflow", std::string("outflow must not list a side along a periodic axis, got \"") +
                                       ObjectReader::side_names[side] + '"');
    const std::string lost =
        domain.one_of("lost", {"error", "delete"},
                      {"What happens to a particle that leaves through another side: error ends the run with "
                       "exit code 4, delete removes and records the particle.",
                       R"("delete")"},
                      "error");
    o.delete_lost = lost == "delete";
    domain.finish();
}

/// Reads the intervals between outputs, and the keys of earlier versions.
void read_output_times(ObjectReader& o, Case& out)
{
    const Intervals intervals = read_intervals(o, out.h, out.end);
    out.interval = intervals.rows;
    out.frame_interval = intervals.frames;
    o.note(key_without_effect, "positive",
           {"A key of earlier versions without effect, which is still read, with a notice: a checkpoint can "
            "be written after every step, and it does not change the results.",
            {},
            R"("deprecated": true)"});
    if (o.has(key_without_effect)) {
        o.positive(key_without_effect);
        out.notices.push_back(out.source.place(std::string("/") + key_without_effect) + ": " +
                              key_without_effect +
                              " has no effect: a checkpoint can be written after every step");
    }
    for (const auto& [old_name, name] : renamed_keys) {
        o.note(old_name, "positive",
               {"Old name of " + name + ". It is still read, with a notice.", {}, R"("deprecated": true)"});
        o.note_exclusive(std::array{old_name, name});
    }
}

}  // namespace

void read_options(ObjectReader& o, Case& out, WorldOptions& world)
{
    o.defines(
        "case", "Case",
        "HILDA granular case file, version 1: spheres, boundaries, materials and contact laws. Quantities "
        "are in SI units and angles in radians; vectors are in the global frame. The program checks further "
        "rules that this schema does not express: every pair of materials that can touch has a law, "
        "particles start within the domain and overlap by at most 5 % of a radius, the step is stable for "
        "the contact stiffnesses, and names refer to entries of the same file.");
    o.note("hilda_case", R"("const": 1)", {"Version of the format.", "1"});
    o.version("hilda_case");
    o.allow_schema({"Path or address of the JSON schema of cases, for editors. It has no effect on the case.",
                    R"("../granular/case.schema.json")"});
    out.name = o.text("name", {"Name of the case in the summary.", R"("bed")"}, "case");
    read_domain(
        o.object("domain", {"Domain of the particles.", R"({"low": [0, 0, 0], "high": [0.05, 0.05, 0.1]})"},
                 "domain"),
        world);
    world.gravity =
        o.vec3("gravity", {"Acceleration of gravity [m/s^2], in the global frame.", "[0, 0, -1.62]"},
               Vec3{0, 0, -9.81});
    out.h = world.h = o.positive("step", {"Time step [s]. A step above the stability limit of the contacts "
                                          "is rejected, unless --accept-step is given.",
                                          "5e-6"});
    out.end = o.positive("end", {"End time of the run [s]. At most 9e15 steps.", "0.2"});
    if (constexpr double max_steps = 9e15; out.end / out.h > max_steps)
        o.fail("end", "end must be at most 9e15 steps, got " + io::shortest(out.end));
    read_output_times(o, out);
    world.skin =
        o.number("skin",
                 {"Skin of the neighbour list, in median diameters of the particles [-]. The list is rebuilt "
                  "when a particle has moved by half the skin. Results depend on it in their last digits.",
                  "0.2", R"("exclusiveMinimum": 0, "maximum": 1)"},
                 world.skin);
    if (!(world.skin > 0 && world.skin <= 1))
        o.fail("skin", "skin must be positive and at most 1 diameter, got " + io::shortest(world.skin));
    o.positive("skin", {}, world.skin);  // in single precision
    world.largest_overlap = o.number(
        "largest_overlap",
        {"Largest overlap of two bodies, over the smaller radius [-]. The run ends above it. With more than "
         "0.5, for very soft particles, it begins with a notice.",
         "0.8", R"("exclusiveMinimum": 0, "maximum": 1)"},
        world.largest_overlap);
    if (!(world.largest_overlap > 0 && world.largest_overlap <= 1))
        o.fail("largest_overlap",
               "largest_overlap must be positive and at most 1, got " + io::shortest(world.largest_overlap));
    if (world.largest_overlap > 0.5)
        out.notices.push_back(o.place("largest_overlap") + ": overlaps of up to " +
                              io::shortest(world.largest_overlap) +
                              " of a radius are accepted; the contact laws hold for small overlaps");
    world.start_overlap = o.number(
        "start_overlap",
        {"Largest overlap of particles at the start and of inserted ones, over the smaller radius [-], at "
         "most largest_overlap. With more than 0.05, for example to continue from the table of a bed of soft "
         "particles, the run begins with a notice.",
         "0.4", R"("exclusiveMinimum": 0, "maximum": 1)"},
        std::min(world.start_overlap, world.largest_overlap));
    if (!(world.start_overlap > 0 && world.start_overlap <= world.largest_overlap))
        o.fail("start_overlap", "start_overlap must be positive and at most largest_overlap = " +
                                    io::shortest(world.largest_overlap) + ", got " +
                                    io::shortest(world.start_overlap));
    if (world.start_overlap > 0.05)
        out.notices.push_back(
            o.place("start_overlap") + ": overlaps of up to " + io::shortest(world.start_overlap) +
            " of a radius are accepted at the start; contacts that are deeper than 0.05 push "
            "the particles apart unless their weight holds them");
    world.scheme = read_scheme(o);
    world.orientation = o.flag("orientation",
                               {"If true, the orientations of the particles are integrated and written to "
                                "tables and frames. They have no effect on the motion.",
                                "true"},
                               false);
}

Material read_material(ObjectReader& o)
{
    o.defines("material", "Material", "Material of particles and boundaries.");
    Material material{
        .name = o.name("name", {"Name by which laws, particles, fills and boundaries refer to the material.",
                                R"("glass")"}),
        .density = o.positive("density", {"Density [kg/m^3].", "2500"}),
        .E = o.positive("E", {"Young's modulus E [Pa]. Values below those of the real material are common, "
                              "since they allow larger steps.",
                              "7e7"}),
        .nu = o.number(
            "nu", {"Poisson's ratio [-].", "0.24", R"("exclusiveMinimum": -1, "exclusiveMaximum": 0.5)"})};
    if (!(material.nu > -1 && material.nu < 0.5))
        o.fail("nu", "nu must be above -1 and below 0.5, got " + io::shortest(material.nu));
    o.finish();
    return material;
}

}  // namespace hilda::granular
