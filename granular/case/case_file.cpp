// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/case_file.hpp"

#include "granular/case/boundary_keys.hpp"
#include "granular/case/continued_case.hpp"
#include "granular/case/falling_tools.hpp"
#include "granular/case/mesh_notices.hpp"
#include "granular/case/output_keys.hpp"
#include "granular/case/pair_keys.hpp"
#include "granular/case/particles/fill.hpp"
#include "granular/fields/field_sums.hpp"
#include "io/error.hpp"
#include "io/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace hilda::granular {

namespace {

Scheme read_scheme(ObjectReader& o)
{
    const std::vector<std::string> names(std::begin(scheme_names), std::end(scheme_names));
    const std::string name = o.one_of("integrator", names, names[0]);
    return static_cast<Scheme>(std::find(names.begin(), names.end(), name) - names.begin());
}

Material read_material(ObjectReader o)
{
    Material material{
        .name = o.name("name"), .density = o.positive("density"), .E = o.positive("E"), .nu = o.number("nu")};
    if (!(material.nu > -1 && material.nu < 0.5))
        o.fail("nu", "nu must be above -1 and below 0.5, got " + io::shortest(material.nu));
    o.finish();
    return material;
}

void read_domain(ObjectReader domain, WorldOptions& o)
{
    o.low = domain.vec3("low"), o.high = domain.vec3("high");
    for (const auto& [low, high, axis] :
         {std::tuple{o.low.x, o.high.x, 0u}, {o.low.y, o.high.y, 1u}, {o.low.z, o.high.z, 2u}})
        if (!(low < high))
            domain.fail("high", axis,
                        "high must be above low, " + io::shortest(low) + ", got " + io::shortest(high));
    o.periodic = domain.flags("periodic", o.periodic);
    o.outflow = domain.sides("outflow");
    for (std::size_t side = 0; side < o.outflow.size(); ++side)
        if (o.outflow[side] && o.periodic[side / 2])
            domain.fail("outflow", std::string("outflow must not list a side along a periodic axis, got \"") +
                                       ObjectReader::side_names[side] + '"');
    o.delete_lost = domain.one_of("lost", {"error", "delete"}, "error") == "delete";
    domain.finish();
}

/// Compares an estimate of the required memory with the available memory. Throws io::PlacedError.
///
/// Particles are inserted and outputs are written in pieces, so that the host needs little more than the
/// arrays of the world. A table of contacts is sorted in memory; a settled bed has 2.3 contacts per particle.
void check_memory(const io::JsonSource& source, double particles, double largest, const WorldOptions& o,
                  bool rotation_laws, const std::vector<FillSpec>& fills, double inserted,
                  const OutputSpecs& outputs, const Environment& available)
{
    constexpr double gigabyte = 1e9, of_output = 8, of_contacts = 2 * 2.3 * sizeof(ContactRecord),
                     of_cell = 4;
    double of_fields = 0;  // cells
    for (const FieldSpec& f : outputs.fields) of_fields += static_cast<double>(f.grid.count());
    std::uint16_t replicas = 0;
    double of_clumps = 0;  // bytes: tables by particle and load of each particle, and the bodies
    for (const FillSpec& f : fills) {
        particles += estimated_count(f);
        constexpr double of_particle = 2 * sizeof(std::uint32_t) + sizeof(Load),
                         of_body = sizeof(ClumpBody) + sizeof(Clump);
        if (f.clumps) of_clumps += estimated_count(f) * (of_particle + of_body / f.clumps.spheres);
        largest = std::max(largest, 2 * f.radius);
        replicas = std::max(replicas, f.replica);
    }
    // An inserted particle is in the arrays, and in a copy while others are inserted.
    constexpr double of_copy = 2 * sizeof(Particle);
    const double own = particles;
    particles += inserted;
    const Vec3 size = o.high - o.low;
    const double edge = largest * (1 + o.skin),
                 cells = (size.x / edge + 1) * (size.y / edge + 1) * (size.z / edge + 1) * (replicas + 1.);
    const auto in_world = [&](Device::Kind device) {
        return 1e-3 * static_cast<double>(World::bytes_needed(1000, rotation_laws, o.orientation, device)) +
               (of_clumps > 0 ? of_clumps / particles : 0);
    };
    const auto check = [&](const char* place, double many, const char* of, double each, std::size_t have,
                           const char* where) {
        if (many * each <= static_cast<double>(have)) return;
        char what[200];
        std::snprintf(what, sizeof what, "%.3g %s need about %.3g GB of memory%s; %.3g GB are available",
                      many, of, many * each / gigabyte, where, static_cast<double>(have) / gigabyte);
        source.fail(place, what);
    };
    const char* const place = inserted > own ? "/insert" : "/fill";
    check(place, particles, "particles",
          in_world(Device::cpu) + of_output + (available.lists_contacts ? of_contacts : 0) +
              (inserted > 0 ? of_copy : 0),
          available.memory, "");
    check(place, particles, "particles", in_world(Device::cuda), available.device_memory, " of the GPU");
    check("/fields", of_fields, "cells", FieldSums::bytes_of_cell(), available.memory, "");
    if (particles > 0)
        check("/domain", cells, "cells", of_cell, std::min(available.memory, available.device_memory), "");
}

/// Sets the seeds of the fills, then those of the insertions.
void set_seeds(Case& c, std::uint64_t seed)
{
    std::size_t set = 0;
    for (const std::string key : {"fill", "insert"}) {
        const io::Json::Member* entries = c.source.root.member(key);
        const std::size_t number = entries != nullptr ? entries->value.size() : 0;
        for (std::size_t k = 0; k < number; ++k, ++set) {
            const io::Json& one = entries->value.list() != nullptr ? entries->value.at(k) : entries->value;
            if (one.members() != nullptr && one.member("file") == nullptr)
                c.source.set('/' + key + '/' + std::to_string(k) + "/seed=" + std::to_string(seed + set),
                             "--seed " + std::to_string(seed));
        }
    }
    if (set == 0) c.notices.emplace_back("--seed has no effect: the case has no fill");
}

class CaseReader {
public:
    CaseReader(Case& out, const Environment& environment) : out(out), environment(environment) {}

    void read()
    {
        ObjectReader o(out.source, out.source.root, "");
        if (const long version = o.count("hilda_case"); version != 1)
            o.fail("hilda_case", "the version of the format must be 1, got " + std::to_string(version));
        o.allow_schema();
        out.name = o.text("name", "case");
        options(o);
        for (ObjectReader& s : o.objects("stages")) stage(s);
        for (ObjectReader& m : o.objects("materials")) add_material(m);
        if (materials.empty()) o.fail("materials", "a case must have at least one material, got none");
        out.world = std::make_unique<World>(world, materials);
        for (ObjectReader& l : o.objects("laws")) law(l);
        for (ObjectReader& b : o.objects("boundaries")) read_boundaries(b), ++boundary_entry;
        sum_parts();
        for (auto& [n, place] : bounds) add_boundary(n, place);
        set_parts();
        for (ObjectReader& c : o.objects("clumps")) clump(c);
        for (ObjectReader& p : o.objects("particles")) particle(p);
        for (ObjectReader& f : o.objects("fill")) fill_spec(f);
        for (ObjectReader& i : o.objects("insert")) insertion(i);
        check_groups();
        out.outputs = read_outputs(o, world);
        check_groups_of_fields();
        o.finish();
        meshes.check_sizes(*out.world, largest_diameter(), out.notices);
        check_widths();
        double inserted = 0;
        if (out.insertions != nullptr)
            for (const Insertion& i : out.insertions->all) inserted += i.what().largest_count(out.end);
        Environment available = environment;
        available.lists_contacts = environment.lists_contacts || out.outputs.lists_contacts();
        if (environment.with_particles) {
            check_memory(out.source, static_cast<double>(out.world->count()), largest, world, rotation_laws,
                         fills, inserted, out.outputs, available);
            add_fills();
            meshes.check_sides(*out.world, out.notices);
            if (out.insertions == nullptr)
                for (const FallingTool& tool : falling_tools(*out.world, out.boundaries, world.gravity))
                    out.notices.push_back(place_of(tool.boundary) + ": " + tool.text);
        }
        start_motions();
        if (!groups.names.empty()) out.groups = std::make_shared<Groups>(groups);
        if (out.insertions != nullptr) out.insertions->groups = out.groups;
        if (out.insertions != nullptr) out.insertions->start(*out.world, out.end);
    }

private:
    void add_fills()
    {
        double all = 0;
        for (const FillSpec& f : fills) all += estimated_count(f);
        out.world->reserve(static_cast<std::size_t>(all));
        for (std::size_t k = 0; k < fills.size(); ++k) {
            const auto first = static_cast<std::uint32_t>(out.world->count());
            out.entries.emplace_back(first, fill_places[k].pointer());
            groups.add(first, fill_groups[k]);
            fill_places[k].located([&] { add_filled(fills[k]); });
            if (!fills[k].file.empty()) out.tables[fill_places[k].pointer()] = fills[k].file;
            std::vector<Particle>().swap(fills[k].particles);
        }
    }

    void options(ObjectReader& o)
    {
        read_domain(o.object("domain"), world);
        world.device = environment.device;
        world.gravity = o.vec3("gravity", Vec3{0, 0, -9.81});
        out.h = world.h = o.positive("step");
        out.end = o.positive("end");
        if (constexpr double max_steps = 9e15; out.end / out.h > max_steps)
            o.fail("end", "end must be at most 9e15 steps, got " + io::shortest(out.end));
        const Intervals intervals = read_intervals(o, out.h, out.end);
        out.interval = intervals.rows;
        out.frame_interval = intervals.frames;
        if (o.has(key_without_effect)) {
            o.positive(key_without_effect);
            out.notices.push_back(out.source.place(std::string("/") + key_without_effect) + ": " +
                                  key_without_effect +
                                  " has no effect: a checkpoint can be written after every step");
        }
        world.skin = o.number("skin", world.skin);
        if (!(world.skin > 0 && world.skin <= 1))
            o.fail("skin", "skin must be positive and at most 1 diameter, got " + io::shortest(world.skin));
        o.positive("skin", world.skin);  // in single precision
        world.scheme = read_scheme(o);
        world.orientation = o.flag("orientation", false);
    }

    void stage(ObjectReader& o)
    {
        out.stage_specs.push_back(read_stage(o, out.h));
        const StageSpec& now = out.stage_specs.back();
        for (const StageSpec& other : out.stage_specs)
            if (&other != &now && other.name == now.name)
                o.fail("name", "two stages have the same name, got " + io::described(now.name));
        world.removable = world.removable || !now.remove.empty();
    }

    /// The number of the group of an entry
    int group(ObjectReader& o)
    {
        if (!o.has("group")) return Groups::none;
        const std::string name = o.name("group");
        if (name.find_first_of(",\"") != std::string::npos)
            o.fail("group", "group must not contain commas and quotes, because it is in tables, got " +
                                io::described(name));
        return groups.number(name);
    }

    void check_groups_of_fields() const
    {
        for (std::size_t k = 0; k < out.outputs.fields.size(); ++k)
            if (const std::string& name = out.outputs.fields[k].group; !name.empty())
                check_group("/fields/" + std::to_string(k) + "/group", name);
    }

    void check_group(const std::string& pointer, const std::string& name) const
    {
        if (std::find(groups.names.begin(), groups.names.end(), name) == groups.names.end())
            out.source.fail(pointer, "no entry has the group" + io::with_nearest(name, groups.names));
    }

    void check_groups() const
    {
        for (std::size_t k = 0; k < out.stage_specs.size(); ++k)
            for (std::size_t m = 0; m < out.stage_specs[k].remove.size(); ++m)
                if (const Selection& s = out.stage_specs[k].remove[m];
                    !s.group.empty() || s.region.shape == CutRegion::Shape::everywhere)
                    check_group("/stages/" + std::to_string(k) + "/remove/" + std::to_string(m), s.group);
    }

    void add_material(ObjectReader& o)
    {
        Material m = read_material(o);
        for (const Material& other : materials)
            if (other.name == m.name)
                o.fail("name", "two materials have the same name, got " + io::described(m.name));
        materials.push_back(std::move(m));
    }

    int material(ObjectReader& o)
    {
        const std::string name =
            o.text("material", materials.size() == 1 ? std::optional(materials[0].name) : std::nullopt);
        return material_named(name, materials, [&](const std::string& what) { o.fail("material", what); });
    }

    void law(ObjectReader& o)
    {
        const auto [i, j] = read_between(o, materials);
        if (const auto [first, is_new] = law_places.emplace(std::minmax(i, j), o.place()); !is_new)
            o.fail("between", "two laws have the same materials, got " + io::described(materials[i].name) +
                                  " and " + io::described(materials[j].name) + "; first at " + first->second);
        const PairLaw pair = read_pair(o, materials[i], materials[j], out.notices);
        rotation_laws = rotation_laws || pair.resists_rotation();
        o.located([&, i = i, j = j] { out.world->set_law(i, j, pair); });
        o.finish();
    }

    double largest_diameter() const  ///< of the particles [m]
    {
        double diameter = largest;
        for (const FillSpec& f : fills) diameter = std::max(diameter, 2 * f.radius);
        return diameter;
    }

    void check_widths()
    {
        for (std::size_t k = 0; k < out.outputs.fields.size(); ++k)
            if (const std::string what = width_notice(out.outputs.fields[k], largest_diameter());
                !what.empty())
                out.notices.push_back(out.source.place("/fields/" + std::to_string(k) + "/width") + ": " +
                                      what);
    }

    /// Reads the boundaries of an entry.
    void read_boundaries(ObjectReader& o)
    {
        const int boundary_material = material(o);
        const std::string name = o.name("name", "boundary " + std::to_string(bounds.size()));
        if (name.find_first_of(",\"") != std::string::npos)
            o.fail("name",
                   "name must not contain commas and quotes, because it is part of column names, got " +
                       io::described(name));
        for (NamedBoundary& n : read_boundary(o, name)) {
            if (find(n.name) != nullptr)
                o.fail("name", "two boundaries have the same name, got " + io::described(n.name));
            n.boundary.material = boundary_material;
            bounds.emplace_back(std::move(n), o);
            out.entry_of_boundary.push_back(boundary_entry);
        }
        o.finish();
    }

    /// The place of the entry of boundary number k
    std::string place_of(int k) const { return bounds[static_cast<std::size_t>(k)].second.place(); }

    /// The boundary with this name, or nullptr
    const NamedBoundary* find(const std::string& name) const
    {
        const auto at =
            std::find_if(bounds.begin(), bounds.end(), [&](const auto& b) { return b.first.name == name; });
        return at == bounds.end() ? nullptr : &at->first;
    }

    /// Checks the keys part_of, and sets the mass properties of the bodies that take them from their parts.
    void sum_parts()
    {
        for (const auto& [n, o] : bounds) {
            if (n.part_of.empty()) continue;
            const NamedBoundary* const body = find(n.part_of);
            if (body == nullptr)
                o.fail("part_of", "part_of must name a boundary, got " + io::described(n.part_of));
            if (!body->part_of.empty())
                o.fail("part_of", "part_of must name a boundary that is not a part itself, got " +
                                      io::described(n.part_of) + ", which is a part of " +
                                      io::described(body->part_of));
            if (body->sums_parts && !n.solid)
                o.fail("", "a part of " + io::described(n.part_of) +
                               ", which has from_parts, needs a density of its solid, got none");
            if (!body->sums_parts && n.solid)
                o.fail("density", "density of a part needs a body with from_parts true, got " +
                                      io::described(n.part_of) + " without it");
        }
        for (auto& [n, o] : bounds) {
            if (!n.sums_parts) continue;
            std::vector<PlacedSolid> solids;
            for (const auto& other : bounds)
                if (other.first.part_of == n.name)
                    solids.push_back({*other.first.solid, other.first.boundary.r, other.first.boundary.p});
            if (solids.empty()) o.fail("from_parts", "from_parts needs parts with part_of, got none");
            const SolidBody body = sum(solids);
            n.boundary.mass = body.mass, n.boundary.inertia = body.inertia, n.boundary.r = body.centre;
        }
    }

    void add_boundary(NamedBoundary& n, ObjectReader& o)
    {
        n.motion.boundary = o.located([&] {
            return n.mesh ? out.world->add(n.boundary, *n.mesh, n.two_sided) : out.world->add(n.boundary);
        });
        if (n.mesh) meshes.add(o.place(), n, *out.world, out.notices);
        n.mesh.reset();  // the world has its triangles
        if (n.motion.is_prescribed()) motions.emplace_back(n.motion, o);
        if (n.part_of.empty() ? n.moves() : find(n.part_of)->moves()) out.moving.push_back(n.motion.boundary);
        if (n.boundary.mass > 0 && free.empty()) free = o.pointer();
        out.boundaries.push_back(n.name);
    }

    /// Attaches the parts to their bodies.
    void set_parts() const
    {
        for (const auto& [n, o] : bounds)
            if (!n.part_of.empty())
                o.located([&, &part = n] {
                    out.world->set_part(part.motion.boundary, find(part.part_of)->motion.boundary);
                });
        out.world->set_boundary_names(out.boundaries);
    }

    /// The number of the boundary that the key attached_to names, or -1
    int attached_to(ObjectReader& o)
    {
        if (!o.has("attached_to")) return -1;
        const std::string name = o.one_of("attached_to", out.boundaries);
        const auto at = std::find(out.boundaries.begin(), out.boundaries.end(), name);
        const int number = static_cast<int>(at - out.boundaries.begin());
        if (out.world->all_boundaries()[static_cast<std::size_t>(number)].mass > 0)
            o.fail("attached_to",
                   "attached_to must name a boundary without a mass, got " + io::described(name));
        for (const char* key : {"v", "omega", "random_v"})
            if (o.has(key)) o.fail(key, std::string(key) + " must not be given together with attached_to");
        return number;
    }

    std::uint16_t replica(ObjectReader& o)
    {
        constexpr long most = 0xffff;
        const long number = o.count("replica", 0);
        if (number > most) o.fail("replica", "replica must be at most 65535, got " + std::to_string(number));
        if (number > 0 && !free.empty())
            o.fail("replica", "replica must be 0 if a boundary has a mass, as " + free + " has, got " +
                                  std::to_string(number));
        return static_cast<std::uint16_t>(number);
    }

    void clump(ObjectReader& o)
    {
        const int number = material(o);
        const ClumpTemplate t =
            read_clump(o, *out.world, number, materials[static_cast<std::size_t>(number)]);
        o.located([&] { out.world->add_template(t); });
        o.finish();
    }

    void single_clump(ObjectReader& o)
    {
        const Clump c = read_single_clump(o, *out.world, replica(o));
        const ClumpTemplate& t = out.world->clump_templates()[static_cast<std::size_t>(c.shape)];
        largest = std::max(largest, 2 * c.scale * t.bounding_radius());
        const int of = group(o);
        o.finish();
        if (!environment.with_particles) return;
        const std::uint32_t id = o.located([&] { return out.world->add_clump(c); });
        groups.add(id, of);
        out.entries.emplace_back(id, o.pointer());
    }

    void particle(ObjectReader& o)
    {
        if (o.has("clump")) return single_clump(o);
        if (o.has("scale")) o.fail("scale", "scale is only for a particle with clump");
        Particle p{.r = o.vec3("r"),
                   .radius = o.positive("radius"),
                   .material = material(o),
                   .v = o.vec3("v", Vec3{0, 0, 0}),
                   .omega = o.vec3("omega", Vec3{0, 0, 0}),
                   .fixed = o.flag("fixed", false),
                   .replica = replica(o),
                   .attached_to = attached_to(o)};
        if (o.has("orientation")) {
            if (!world.orientation) o.fail("orientation", "orientation requires /orientation to be true");
            const std::vector<double> e = o.numbers("orientation", 4);
            p.e = {e[0], e[1], e[2], e[3]};
        }
        largest = std::max(largest, 2 * p.radius);
        const std::optional<Vec3> force = o.has("force") ? std::optional(o.vec3("force")) : std::nullopt;
        const int of = group(o);
        o.finish();
        if (!environment.with_particles) return;
        const std::uint32_t id = o.located([&] { return out.world->add(p); });
        groups.add(id, of);
        out.entries.emplace_back(id, o.pointer());
        if (force) out.world->set_force(id, *force);
    }

    void fill_spec(ObjectReader& o)
    {
        const FilledClumps clumps = read_filled_clumps(o, *out.world);
        FillSpec spec = read_fill(o, clumps ? std::optional(clumps.radius) : std::nullopt);
        spec.clumps = clumps;
        const bool from_csv = !spec.particles.empty();
        if (from_csv && clumps) o.fail("clump", "clump must not be given together with a table");
        if (!clumps) spec.material = from_csv && !o.has("material") ? -1 : material(o);
        spec.replica = replica(o);
        spec.attached_to = attached_to(o);
        if (!world.orientation)
            for (Particle& p : spec.particles) p.e = Particle().e;
        const int of = group(o);
        if (from_csv) out.files_read += "\n" + o.pointer("file") + ' ' + std::to_string(spec.checksum);
        o.finish();
        fill_groups.push_back(of);
        fills.push_back(std::move(spec));
        fill_places.push_back(o);
    }

    void insertion(ObjectReader& o)
    {
        if (out.insertions == nullptr) out.insertions = std::make_shared<Insertions>();
        std::vector<Insertion>& all = out.insertions->all;
        InsertionSpec spec =
            read_insertion(o, "insertion " + std::to_string(all.size()), out.h, world.gravity);
        for (const Insertion& other : all)
            if (other.what().name == spec.name)
                o.fail("name", "two insertions have the same name, got " + io::described(spec.name));
        spec.group = group(o);
        spec.material = material(o);
        spec.density = materials[static_cast<std::size_t>(spec.material)].density;
        spec.replica = replica(o);
        const auto [low, high] = spec.region.bounds(spec.sizes.largest());
        const Vec3 from = world.low, to = world.high;
        for (const auto& [axis, inside] : {std::pair{'x', low.x >= from.x && high.x <= to.x},
                                           {'y', low.y >= from.y && high.y <= to.y},
                                           {'z', low.z >= from.z && high.z <= to.z}})
            if (!inside)
                o.fail("region", std::string("region must be within the domain along ") + axis + ", got a " +
                                     spec.region.description());
        o.finish();
        largest = std::max(largest, 2 * spec.sizes.largest());
        o.located([&] { World(world, materials).expect(spec.samples(), 0); });  // may refuse them
        all.emplace_back(spec);
    }

    /// Adds the particles of a fill. A message about a particle of a table has its line.
    void add_filled(const FillSpec& spec) const
    {
        std::size_t number = 0;
        Random turns(SplitMix::mixed(spec.seed));
        fill(spec, [&](const Particle& p) {
            try {
                spec.clumps ? out.world->add_clump(spec.clumps.at(p, turns)) : out.world->add(p);
            } catch (const io::InvalidInput& e) {
                if (spec.file.empty()) throw;
                throw io::InvalidInput(place_in_table(spec.file, number) + ": " + e.what());
            }
            ++number;
        });
    }

    /// Evaluates the formulas of the boundaries for the first step, and registers them for all steps.
    void start_motions() const
    {
        for (const auto& [motion, o] : motions) {
            out.motions->push_back(motion);
            try {
                apply_motions(*out.world, {motion}, out.h);
            } catch (const NotFinite& e) {
                o.fail(e.what());
            }
        }
        out.world->before_each_step([all = out.motions, h = out.h](World& w) { apply_motions(w, *all, h); });
    }

    Case& out;
    const Environment& environment;
    WorldOptions world;
    std::vector<Material> materials;
    std::map<std::pair<int, int>, std::string> law_places;  ///< by the smaller and the larger material index
    std::vector<std::pair<BoundaryMotion, ObjectReader>> motions;
    std::vector<std::pair<NamedBoundary, ObjectReader>> bounds;  ///< with their entries
    MeshNotices meshes;
    std::size_t boundary_entry = 0;  ///< of the entry that is read
    std::string free;                ///< pointer of the first boundary with a mass
    double largest = 0;              ///< diameter of the particles that are given one by one [m]
    bool rotation_laws = false;
    std::vector<FillSpec> fills;
    std::vector<ObjectReader> fill_places;
    std::vector<int> fill_groups;
    Groups groups;
};

}  // namespace

namespace {

/// A case with the changes of the environment, before it is read
Case changed_case(const std::string& text, const std::string& file, const Environment& environment)
{
    Case out{.source = io::JsonSource(text, file)};
    out.source.folder = environment.folder;
    out.source.rename("every", "interval");
    out.source.rename("frames_every", "frame_interval");
    out.source.rename("checkpoint_every", "checkpoint_interval");
    for (const Setting& setting : environment.settings)
        out.source.set(with_numbers(out.source.root, setting.change),
                       setting.origin.empty() ? "--set " + io::in_quotes(setting.change) : setting.origin);
    out.notices = out.source.notices;
    if (environment.seed) set_seeds(out, *environment.seed);
    if (environment.continues != nullptr) keep_intervals(out.source, *environment.continues);
    return out;
}

}  // namespace

std::string with_numbers(const io::Json& root, const std::string& pointer)
{
    for (const std::string list : {"boundaries", "insert"}) {
        const std::string start = '/' + list + '/';
        const io::Json::Member* entries = root.member(list);
        if (!pointer.starts_with(start) || entries == nullptr || entries->value.list() == nullptr) continue;
        const std::size_t end = std::min(pointer.find_first_of("/=", start.size()), pointer.size());
        const std::string key = pointer.substr(start.size(), end - start.size());
        if (key.find_first_not_of("0123456789") == std::string::npos) continue;  // a number
        for (std::size_t k = 0; k < entries->value.size(); ++k) {
            const io::Json::Member* found = entries->value.at(k).member("name");
            if (found != nullptr && found->value.string() != nullptr &&
                io::pointer_to("", *found->value.string()) == '/' + key)
                return start + std::to_string(k) + pointer.substr(end);
        }
    }
    return pointer;
}

io::JsonSource changed_source(const std::string& text, const std::string& file,
                              const Environment& environment)
{
    return changed_case(text, file, environment).source;
}

Case read_case(const std::string& text, const std::string& file, const Environment& environment)
{
    Case out = changed_case(text, file, environment);
    CaseReader(out, environment).read();
    out.source.remove(key_without_effect);
    return out;
}

Case read_case(const io::JsonSource& source, const Environment& environment)
{
    Case out{.source = source};
    CaseReader(out, environment).read();
    return out;
}

void insert_particles(const Case& c)
{
    // Messages of the world refer to particles by their ids.
    const auto refuse = [&](std::string what) {
        std::string place;
        unsigned id = 0;
        if (std::sscanf(what.c_str(), "particle %u", &id) == 1) {
            std::uint32_t number = 0;  // of the particle in its entry
            for (const auto& [first, entry] : c.entries)
                if (first <= id) place = entry, number = id - first;
            if (const auto table = c.tables.find(place); table != c.tables.end())
                what = place_in_table(table->second, number) + ": " + what;
        } else if (what.starts_with("laws: ") || what.starts_with("world: ")) {
            place = "/laws";
        } else if (what.starts_with("domain: ")) {
            place = "/domain";
        }
        c.source.fail(place, what);
    };
    try {
        c.world->step(0);
        c.world->check_finite();
        c.world->check_loads(c.world->totals());
    } catch (const io::InvalidInput& e) {
        refuse(e.what());
    } catch (const NotFiniteState& e) {
        refuse(e.what());
    }
}

}  // namespace hilda::granular
