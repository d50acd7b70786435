// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/case_file.hpp"

#include "granular/case/boundary_list.hpp"
#include "granular/case/continued_case.hpp"
#include "granular/case/entry_keys.hpp"
#include "granular/case/memory_estimate.hpp"
#include "granular/case/option_keys.hpp"
#include "granular/case/output_keys.hpp"
#include "granular/case/pair_keys.hpp"
#include "granular/case/particles/fill_list.hpp"
#include "granular/case/particles/particle_keys.hpp"
#include "granular/reading/clump_keys.hpp"
#include "io/error.hpp"
#include "io/nearest.hpp"
#include "io/provenance.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

namespace hilda::granular {

namespace {

class CaseReader {
public:
    CaseReader(Case& out, const Environment& environment)
        : out(out), environment(environment), boundaries(out)
    {}

    void read()
    {
        ObjectReader o(out.source, out.source.root, "");
        read_options(o, out, world);
        world.device = environment.device, world.removable = environment.removable;
        for (ObjectReader& s :
             o.objects("stages", "stage",
                       {"Parts of the run, in their order: each changes entries of the case at its start, "
                        "and ends at a time or when the particles are at rest. The run ends with the last "
                        "one, at the latest at end.",
                        R"([{"name": "settle", "duration": 0.5, "until": {"share": 1e-4}}, )"
                        R"({"name": "shake", "set": {"/gravity": [1, 0, -9.81]}}])"}))
            stage(s);
        for (ObjectReader& m : o.objects("materials", "material",
                                         {"Materials of particles and boundaries.",
                                          R"([{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}])"},
                                         true))
            add_material(m);
        if (keys.materials.empty()) o.fail("materials", "a case must have at least one material, got none");
        out.world = std::make_unique<World>(world, keys.materials);
        for (ObjectReader& l :
             o.objects("laws", "law",
                       {"Contact laws, one for each pair of materials that can touch.",
                        R"([{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"}}])"}))
            law(l);
        for (ObjectReader& b : o.objects("boundaries", "boundary",
                                         {"Boundaries of the particles.",
                                          R"([{"name": "floor", "type": "plane", "normal": [0, 0, 1]}])"}))
            boundaries.read(b, keys);
        boundaries.add(keys);
        for (ObjectReader& c :
             o.objects("clumps", "clump",
                       {"Templates of clumps: spheres that move as one rigid body. Single clumps are entries "
                        "of particles with the key clump; fills with this key consist of clumps.",
                        R"([{"name": "pair", "spheres": [{"r": [5e-4, 0, 0], "radius": 1e-3}, )"
                        R"({"r": [-5e-4, 0, 0], "radius": 1e-3}]}])"}))
            clump(c);
        for (ObjectReader& p : o.objects(
                 "particles", "particle",
                 {"Particles and clumps given one by one.", R"([{"r": [0, 0, 0.01], "radius": 0.001}])"}))
            largest = std::max(largest, read_particle(p, out, keys, world, environment.with_particles));
        for (ObjectReader& f :
             o.objects("fill", "fill",
                       {"Sets of particles.",
                        R"([{"type": "lattice", "low": [0, 0, 0], "high": [0.03, 0.02, 0.03], )"
                        R"("radius": 0.001}])"}))
            fills.read(f, out, keys, world);
        for (ObjectReader& i :
             o.objects("insert", "insertion",
                       {"Particles that are inserted during the run.",
                        R"([{"rate": 2000, "to": 0.5, "radius": 0.001, "v": [0, 0, -1], "region": )"
                        R"({"type": "box", "low": [0, 0, 0.09], "high": [0.03, 0.02, 0.1]}}])"}))
            insertion(i);
        check_groups();
        out.outputs = read_outputs(o, world);
        check_groups_of_fields();
        o.finish();
        boundaries.check_sizes(largest_diameter());
        check_widths();
        Environment available = environment;
        available.lists_contacts = environment.lists_contacts || out.outputs.lists_contacts();
        if (environment.with_particles) {
            const CaseSize size{.particles = static_cast<double>(out.world->count()),
                                .insertions = out.insertions.get(),
                                .end = out.end,
                                .diameter = largest,
                                .rotation_laws = rotation_laws};
            check_memory(out.source, size, world, fills.specs(), out.outputs, available);
            fills.add_to(out, keys);
            boundaries.check_sides();
            if (out.insertions == nullptr) boundaries.check_tools(world.gravity);
        }
        boundaries.start_motions();
        if (!keys.groups.names.empty()) out.groups = std::make_shared<Groups>(keys.groups);
        if (out.insertions != nullptr) out.insertions->groups = out.groups;
        if (out.insertions != nullptr) out.insertions->start(*out.world, out.end);
    }

private:
    void stage(ObjectReader& o)
    {
        out.stage_specs.push_back(read_stage(o, out.h));
        const StageSpec& now = out.stage_specs.back();
        for (const StageSpec& other : out.stage_specs)
            if (&other != &now && other.name == now.name)
                o.fail("name", "two stages have the same name, got " + io::described(now.name));
        world.removable = world.removable || !now.remove.empty();
        for (const auto& [name, selections] : now.groups) {
            EntryKeys::check_group_name(o, "groups", name);
            keys.groups.number(name);
        }
    }

    void check_groups_of_fields() const
    {
        for (std::size_t k = 0; k < out.outputs.fields.size(); ++k)
            if (const std::string& name = out.outputs.fields[k].group; !name.empty())
                check_group("/fields/" + std::to_string(k) + "/group", name);
    }

    void check_group(const std::string& pointer, const std::string& name) const
    {
        const std::vector<std::string>& names = keys.groups.names;
        if (std::find(names.begin(), names.end(), name) == names.end())
            out.source.fail(pointer, "no entry has the group" + io::with_nearest(name, names));
    }

    void check_groups() const
    {
        const auto check = [&](const std::string& list, const std::vector<Selection>& selections) {
            for (std::size_t m = 0; m < selections.size(); ++m)
                if (const Selection& s = selections[m];
                    !s.group.empty() || s.region.shape == CutRegion::Shape::everywhere)
                    check_group(list + '/' + std::to_string(m), s.group);
        };
        for (std::size_t k = 0; k < out.stage_specs.size(); ++k) {
            const std::string stage = "/stages/" + std::to_string(k);
            for (const auto& [name, selections] : out.stage_specs[k].groups)
                check(io::pointer_to(stage + "/groups", name), selections);
            check(stage + "/remove", out.stage_specs[k].remove);
        }
    }

    void add_material(ObjectReader& o)
    {
        Material m = read_material(o);
        for (const Material& other : keys.materials)
            if (other.name == m.name)
                o.fail("name", "two materials have the same name, got " + io::described(m.name));
        keys.materials.push_back(std::move(m));
    }

    void law(ObjectReader& o)
    {
        const auto [i, j] = read_between(o, keys.materials);
        if (const auto [first, is_new] = law_places.emplace(std::minmax(i, j), o.place()); !is_new)
            o.fail("between", "two laws have the same materials, got " +
                                  io::described(keys.materials[i].name) + " and " +
                                  io::described(keys.materials[j].name) + "; first at " + first->second);
        const PairLaw pair = read_pair(o, keys.materials[i], keys.materials[j], out.notices);
        rotation_laws = rotation_laws || pair.resists_rotation();
        o.located([&, i = i, j = j] { out.world->set_law(i, j, pair); });
        o.finish();
    }

    double largest_diameter() const  ///< of the particles [m]
    {
        double diameter = largest;
        for (const FillSpec& f : fills.specs()) diameter = std::max(diameter, 2 * f.radius);
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

    void clump(ObjectReader& o)
    {
        o.defines("clump", "Clump",
                  "A template of clumps: spheres, which may overlap, that move as one rigid body. Mass, "
                  "centre of mass and inertia are those of a homogeneous body, the union of the spheres, or "
                  "mass and inertia are given.",
                  R"("if": {"required": ["mass"]}, "then": {"required": ["inertia"]}, )"
                  R"("else": {"not": {"anyOf": [{"required": ["inertia"]}, {"required": ["centre"]}]}})");
        const int number = keys.material(o);
        const ClumpTemplate t =
            read_clump(o, *out.world, number, keys.materials[static_cast<std::size_t>(number)]);
        o.located([&] { out.world->add_template(t); });
        o.finish();
    }

    void insertion(ObjectReader& o)
    {
        if (out.insertions == nullptr) out.insertions = std::make_shared<Insertions>();
        std::vector<Insertion>& all = out.insertions->all;
        InsertionSpec spec =
            read_insertion(o, "insertion " + std::to_string(all.size()), out.h, world.gravity, *out.world);
        for (const Insertion& other : all)
            if (other.what().name == spec.name)
                o.fail("name", "two insertions have the same name, got " + io::described(spec.name));
        spec.group = keys.group(o);
        if (!spec.clumps) {
            spec.material = keys.material(o);
            spec.density = keys.materials[static_cast<std::size_t>(spec.material)].density;
        }
        spec.replica = keys.replica(o);
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
        o.located([&] {  // may refuse them
            World other(world, keys.materials);
            for (const ClumpTemplate& t : out.world->clump_templates()) other.add_template(t);
            spec.announce(other, 0);
        });
        all.emplace_back(spec);
    }

    Case& out;
    const Environment& environment;
    WorldOptions world;
    EntryKeys keys;
    std::map<std::pair<int, int>, std::string> law_places;  ///< by the smaller and the larger material index
    BoundaryList boundaries;
    double largest = 0;  ///< diameter of the particles that are given one by one [m]
    bool rotation_laws = false;
    FillList fills;
};

}  // namespace

Case read_case(const std::string& text, const std::string& file, const Environment& environment)
{
    Case out{.source = changed_source(text, file, environment)};
    out.notices = out.source.notices;
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

io::Json inputs_of(const Case& c, const std::string& file)
{
    std::vector<std::string> files = c.source.files;
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) files.insert(files.begin(), file);
    return io::inputs(files);
}

}  // namespace hilda::granular
