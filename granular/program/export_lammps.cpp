// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/export_lammps.hpp"

#include "granular/case/pair_keys.hpp"
#include "granular/program/lammps_laws.hpp"
#include "io/files.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

std::string vector_text(const Vec3& v)
{
    return io::shortest(v.x) + ' ' + io::shortest(v.y) + ' ' + io::shortest(v.z);
}

class Export {
public:
    explicit Export(const Case& c) : c(c), w(*c.world), particles(c.world->particles())
    {
        check_case();
        check_particles();
        read_laws();
        set_types();
    }

    std::string input() const
    {
        std::string text = head();
        add_pairs(text);
        add_walls(text);
        add_run(text);
        return text;
    }

    void write_data(const io::Append& append) const
    {
        append("LAMMPS data file of the case " + io::in_quotes(c.name) + ", written by hilda-granular\n\n" +
               std::to_string(particles.size()) + " atoms\n" + std::to_string(materials_of_types.size()) +
               " atom types\n\n");
        const Vec3 &low = w.low(), &high = w.high();
        for (const auto& [from, to, axis] :
             {std::tuple{low.x, high.x, 'x'}, {low.y, high.y, 'y'}, {low.z, high.z, 'z'}})
            append(io::shortest(from) + ' ' + io::shortest(to) + ' ' + axis + "lo " + axis + "hi\n");
        append("\nAtoms # sphere\n\n");
        for (const Particle& p : particles) {
            const double density = p.mass > 0 ? p.mass / sphere_volume(p.radius)
                                              : materials[static_cast<std::size_t>(p.material)].density;
            append(std::to_string(p.id + 1) + ' ' + std::to_string(type_of(p.material)) + ' ' +
                   io::shortest(2 * p.radius) + ' ' + io::shortest(density) + ' ' + vector_text(p.r) + '\n');
        }
        append("\nVelocities\n\n");
        for (const Particle& p : particles)
            append(std::to_string(p.id + 1) + ' ' + vector_text(p.fixed ? Vec3{0, 0, 0} : p.v) + ' ' +
                   vector_text(p.omega) + '\n');
    }

private:
    const io::Json* member(const char* key) const
    {
        const io::Json::Member* const found = c.source.root.member(key);
        return found == nullptr ? nullptr : &found->value;
    }
    [[noreturn]] void refuse(const std::string& pointer, const std::string& what) const
    {
        c.source.fail(pointer, what + " has no counterpart in the export to LAMMPS");
    }

    void check_case() const
    {
        if (!c.stage_specs.empty()) refuse("/stages", "a case with stages");
        if (c.insertions != nullptr) refuse("/insert", "an insertion");
        if (w.scheme() != Scheme::velocity_verlet && w.scheme() != Scheme::symplectic_euler)
            refuse("/integrator",
                   std::string("the integrator ") + scheme_names[static_cast<std::size_t>(w.scheme())]);
        if (const io::Json* const domain = member("domain");
            domain->member("outflow") != nullptr && domain->member("outflow")->value.size() > 0)
            refuse("/domain/outflow", "an outflow through single sides");
        refuse_key("particles", "force", "a force on a particle");
        for (const char* list : {"particles", "fill"})
            refuse_key(list, "attached_to", "an attached particle");
    }

    /// Refuses a key of the entries of a list.
    void refuse_key(const std::string& list, const char* key, const std::string& what) const
    {
        const io::Json* const entries = member(list.c_str());
        for (std::size_t k = 0; entries != nullptr && k < entries->size(); ++k)
            if (entries->at(k).member(key) != nullptr)
                refuse('/' + list + '/' + std::to_string(k) + '/' + key, what);
    }

    void check_particles() const
    {
        if (particles.empty())
            c.source.fail("", "a case must have a particle for the export to LAMMPS, got none");
        const auto entry_of = [&](const Particle& p) {
            std::string pointer;
            for (const auto& [first, entry] : c.entries)
                if (first <= p.id) pointer = entry;
            return pointer;
        };
        for (const Particle& p : particles) {
            if (p.clump >= 0) refuse(entry_of(p) + "/clump", "a clump");
            if (p.replica != 0) refuse(entry_of(p) + "/replica", "a replica");
        }
    }

    void read_laws()
    {
        ObjectReader o(c.source, c.source.root, "");
        for (ObjectReader& m : o.objects("materials"))
            materials.push_back({.name = m.name("name"),
                                 .density = m.positive("density"),
                                 .E = m.positive("E"),
                                 .nu = m.number("nu")});
        for (ObjectReader& l : o.objects("laws")) law_between.push_back(read_between(l, materials));
    }

    /// Numbers the materials of the particles as types of atoms, from 1.
    void set_types()
    {
        for (const Particle& p : particles) {
            const auto at = std::find(materials_of_types.begin(), materials_of_types.end(), p.material);
            if (at == materials_of_types.end()) materials_of_types.push_back(p.material);
        }
        std::sort(materials_of_types.begin(), materials_of_types.end());
    }
    int type_of(int material) const
    {
        const auto at = std::find(materials_of_types.begin(), materials_of_types.end(), material);
        return static_cast<int>(at - materials_of_types.begin()) + 1;
    }

    /// The law of two materials. The world has checked that those which can touch have one.
    LammpsLaw law(int i, int j) const
    {
        for (std::size_t k = 0; k < law_between.size(); ++k)
            if (const auto [a, b] = law_between[k]; (a == i && b == j) || (a == j && b == i))
                return lammps_law(w.all_laws()[k], c.source, "/laws/" + std::to_string(k));
        c.source.fail("/laws", "the export to LAMMPS needs a law between " +
                                   io::described(materials[static_cast<std::size_t>(i)].name) + " and " +
                                   io::described(materials[static_cast<std::size_t>(j)].name) + ", got none");
    }

    bool has_fixed() const
    {
        return std::any_of(particles.begin(), particles.end(), [](const Particle& p) { return p.fixed; });
    }

    std::string head() const
    {
        std::string text = "# LAMMPS input of the case " + io::in_quotes(c.name) +
                           ", written by hilda-granular export. For LAMMPS of 29 Sep 2021 or later:\n"
                           "#     lmp -in in.lammps\n"
                           "units           si\natom_style      sphere\nboundary       ";
        for (const bool is_periodic : w.periodic()) text += is_periodic ? " p" : " f";
        // The skin has no influence on the forces.
        double largest = 0;
        for (const Particle& p : particles) largest = std::max(largest, p.radius);
        text +=
            "\nnewton          off\ncomm_modify     vel yes\nread_data       data.lammps\n"
            "neighbor        " +
            io::shortest(0.2 * largest) + " bin\nneigh_modify    delay 0 every 1 check yes\n";
        if (!has_fixed()) return text + "group           moving union all\n";
        text += "group           fixed id";
        for (const Particle& p : particles)
            if (p.fixed) text += ' ' + std::to_string(p.id + 1);
        return text + "\ngroup           moving subtract all fixed\n";
    }

    void add_pairs(std::string& text) const
    {
        text += "\npair_style      granular\n";
        for (const int i : materials_of_types)
            for (const int j : materials_of_types) {
                if (j < i) continue;
                const std::size_t a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
                const std::string types = std::to_string(type_of(i)) + ' ' + std::to_string(type_of(j));
                // An & at the end of a line would continue it.
                text += "# types " + types + ": " + io::in_quotes(materials[a].name) + " and " +
                        io::in_quotes(materials[b].name) + "\npair_coeff      " + types + ' ' +
                        (i == j ? law(i, j).of_material(materials[a]) : law(i, j).of_stiffness()) + '\n';
            }
    }

    /// The arguments of `region` after the name
    std::string region(const Boundary& b, const std::string& pointer) const
    {
        const std::string side = b.inside != 0 ? " side in" : " side out";
        switch (b.shape) {
            case Boundary::Shape::plane:
                return "plane " + vector_text(b.r) + ' ' + vector_text(b.axis);
            case Boundary::Shape::sphere:
                return "sphere " + vector_text(b.r) + ' ' + io::shortest(b.radius) + side;
            case Boundary::Shape::cylinder: {
                const std::string size = ' ' + io::shortest(b.radius) + " INF INF" + side;
                const std::string x = io::shortest(b.r.x), y = io::shortest(b.r.y), z = io::shortest(b.r.z);
                if (std::abs(b.axis.x) == 1) return "cylinder x " + y + ' ' + z + size;
                if (std::abs(b.axis.y) == 1) return "cylinder y " + x + ' ' + z + size;
                if (std::abs(b.axis.z) == 1) return "cylinder z " + x + ' ' + y + size;
                refuse(pointer + "/axis", "a cylinder that is not along x, y or z");
            }
            case Boundary::Shape::mesh:
                refuse(pointer, "a mesh, of which LAMMPS has no walls,");
            default:
                refuse(pointer + "/type", "this type of boundary");
        }
    }

    void add_walls(std::string& text) const
    {
        for (const int m : materials_of_types)
            text += "\ngroup           type" + std::to_string(type_of(m)) + " type " +
                    std::to_string(type_of(m)) + "\ngroup           moving" + std::to_string(type_of(m)) +
                    (has_fixed() ? " subtract type" + std::to_string(type_of(m)) + " fixed\n"
                                 : " union type" + std::to_string(type_of(m)) + '\n');
        for (std::size_t k = 0; k < c.boundaries.size(); ++k) {
            const std::string pointer = "/boundaries/" + std::to_string(c.entry_of_boundary[k]),
                              number = std::to_string(k);
            const Boundary& b = w.all_boundaries()[k];
            const std::string at = region(b, pointer);
            if (c.boundaries[k].find('$') != std::string::npos)
                refuse(pointer + "/name", "the $ of a name, which begins a variable in LAMMPS,");
            if (std::find(c.moving.begin(), c.moving.end(), static_cast<int>(k)) != c.moving.end())
                refuse(pointer, "a boundary that moves");
            text += "\n# wall" + number + ": " + io::in_quotes(c.boundaries[k]) + "\nregion          wall" +
                    number + ' ' + at + " units box\n";
            for (const int m : materials_of_types) {
                const std::string type = std::to_string(type_of(m)), name = "wall" + number + '_' + type;
                text += "fix             " + name + " moving" + type + " wall/gran/region granular " +
                        law(m, b.material).of_stiffness() + " region wall" + number +
                        " contacts\ncompute         " + name + " moving" + type + " reduce sum f_" + name +
                        "[2] f_" + name + "[3] f_" + name + "[4]\n";
            }
            // the forces on the boundary
            for (std::size_t axis = 0; axis < 3; ++axis) {
                text += std::string("variable        ") + "xyz"[axis] + number + " equal ";
                for (const int m : materials_of_types)
                    text += "-c_wall" + number + '_' + std::to_string(type_of(m)) + '[' +
                            std::to_string(axis + 1) + ']';
                text += '\n';
            }
        }
    }

    void add_run(std::string& text) const
    {
        text += "\nfix             nve moving nve/sphere\n";
        if (has_fixed()) text += "fix             freeze fixed freeze\n";
        if (const double g = w.gravity().norm(); g > 0)
            text += "fix             gravity moving gravity " + io::shortest(g) + " vector " +
                    vector_text(w.gravity()) + '\n';
        text += "timestep        " + io::shortest(c.h) +
                "\n\ncompute         ke moving ke\ncompute         rotation moving erotate/sphere\n"
                "variable        t equal time\nvariable        E equal c_ke+c_rotation\n"
                "variable        R equal c_rotation\n";
        std::string columns = "t,kinetic_energy,rotational_energy",
                    values = "$(v_t:%.12g),$(v_E:%.9g),$(v_R:%.9g)", thermo = "step time v_E v_R";
        for (std::size_t k = 0; k < c.boundaries.size(); ++k)
            for (const char axis : {'x', 'y', 'z'}) {
                const std::string variable = axis + std::to_string(k);
                columns += ',' + c.boundaries[k] + "_F" + axis;
                values += ",$(v_" + variable + ":%.9g)";
                thermo += " v_" + variable;
            }
        const std::string rows = std::to_string(steps_in(c.interval, c.h));
        text += "thermo_style    custom " + thermo + "\nthermo          " + rows +
                "\nthermo_modify   norm no lost " + (w.removes() ? "ignore" : "error") +
                " format float %.9g\nfix             rows all print " + rows + " \"" + values +
                "\" file lammps.csv screen no title \"" + columns + "\"\n";
        if (c.frame_interval > 0)
            text += "dump            frames all custom " + std::to_string(steps_in(c.frame_interval, c.h)) +
                    " frames.lammpstrj id type radius x y z vx vy vz omegax omegay omegaz\n"
                    "dump_modify     frames sort id\n";
        text += "run             " + std::to_string(steps_in(c.end, c.h)) + '\n';
    }

    const Case& c;
    const World& w;
    const std::vector<Particle> particles;
    std::vector<Material> materials;
    std::vector<std::array<int, 2>> law_between;  ///< materials of each entry of `laws`
    std::vector<int> materials_of_types;          ///< in ascending order
};

}  // namespace

void export_lammps(const Case& c, const std::string& directory)
{
    const Export files(c);
    const std::string input = files.input();  // refuses before a file is written
    io::make_directory(directory);
    io::write_file(directory + "/data.lammps", [&](const io::Append& append) { files.write_data(append); });
    io::write_file(directory + "/in.lammps", input);
}

}  // namespace hilda::granular
