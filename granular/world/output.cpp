// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/output.hpp"

#include "granular/world/groups.hpp"
#include "io/formats/csv.hpp"
#include "io/formats/vtk.hpp"

namespace hilda::granular {

namespace {

/// Appends the components, each preceded by a comma
void append_csv(std::string& to, const Vec3& v)
{
    for (const double c : {v.x, v.y, v.z}) {
        to += ',';
        io::append_number(to, c);
    }
}

/// Passes a long text on.
void pass_on_full(std::string& text, const io::Append& append_piece)
{
    constexpr std::size_t full = 1 << 20;
    if (text.size() < full) return;
    append_piece(text);
    text.clear();
}

}  // namespace

std::string particles_csv(const World& world)
{
    std::string csv;
    particles_csv(world, [&](std::string_view piece) { csv += piece; });
    return csv;
}

void particles_csv(const World& world, const io::Append& append_piece, const Groups* groups)
{
    const bool orientation = world.has_orientation();
    std::string csv = "id,material,radius,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z";
    if (orientation) csv += ",e0,e1,e2,e3";
    const bool clumps = !world.clump_templates().empty();
    if (groups != nullptr) csv += ",group";
    csv += clumps ? ",clump\n" : "\n";
    world.each_particle([&](const Particle& p) {
        csv += std::to_string(p.id) + ',' + std::to_string(p.material) + ',';
        io::append_number(csv, p.radius);
        append_csv(csv, p.r), append_csv(csv, p.v), append_csv(csv, p.omega);
        for (std::size_t k = 0; orientation && k < 4; ++k) csv += ',', io::append_number(csv, p.e[k]);
        if (groups != nullptr) csv += ',' + std::to_string(groups->of(p.id));
        if (clumps) csv += ',' + std::to_string(p.clump);
        csv += '\n';
        pass_on_full(csv, append_piece);
    });
    append_piece(csv);
}

void clumps_csv(const World& world, const io::Append& append_piece)
{
    std::string csv =
        "id,spheres,shape,mass,scale,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z,e0,e1,e2,e3,Lx,Ly,Lz\n";
    for (const Clump& c : world.clumps()) {
        const ClumpTemplate& t = world.clump_templates()[static_cast<std::size_t>(c.shape)];
        csv += std::to_string(c.id) + ',' + std::to_string(t.spheres.size()) + ',' + std::to_string(c.shape);
        for (const double x : {c.mass, c.scale}) csv += ',', io::append_number(csv, x);
        append_csv(csv, c.r), append_csv(csv, c.v), append_csv(csv, c.omega);
        for (const double e : c.e) csv += ',', io::append_number(csv, e);
        append_csv(csv, c.L);
        csv += '\n';
        pass_on_full(csv, append_piece);
    }
    append_piece(csv);
}

void contacts_csv(const World& world, const io::Append& append_piece)
{
    std::string csv = "i,j,boundary,nx,ny,nz,overlap,Fx,Fy,Fz,ux,uy,uz\n";
    for (const ContactRecord& c : world.contacts()) {
        csv += std::to_string(c.i) + ',' + std::to_string(c.j) + ',' + (c.boundary ? '1' : '0');
        append_csv(csv, c.n);
        csv += ',';
        io::append_number(csv, c.delta);
        append_csv(csv, c.F), append_csv(csv, c.u);
        csv += '\n';
        pass_on_full(csv, append_piece);
    }
    append_piece(csv);
}

void particles_vtp(const World& world, const io::Append& append_piece, const Groups* groups)
{
    io::VtkPolyData file({{"NumberOfPoints", world.count()}});
    const auto array = [&]<class Number>(const char* name, int components, Number, const auto& value) {
        file.array<Number>(name, components, world.count() * static_cast<std::size_t>(components),
                           [&world, value](const std::function<void(std::span<const Number>)>& put) {
                               constexpr std::size_t full = 8192;
                               std::vector<Number> some;
                               world.each_particle([&](const Particle& p) {
                                   for (const auto x : value(p)) some.push_back(static_cast<Number>(x));
                                   if (some.size() < full) return;
                                   put(some);
                                   some.clear();
                               });
                               put(some);
                           });
    };
    const auto three = [](const Vec3& v) { return std::array{v.x, v.y, v.z}; };
    // The small arrays are collected at once. The others take more memory: the particles are computed for
    // each of them.
    std::vector<float> radius;
    std::vector<std::int32_t> material, id, group, clump;
    const bool clumps = !world.clump_templates().empty();
    const auto collected = [&]<class Number>(const char* name, std::vector<Number>& values) {
        file.array<Number>(
            name, 1, world.count(),
            [&values](const std::function<void(std::span<const Number>)>& put) { put(values); });
        values.reserve(world.count());
    };
    file.section("PointData");
    collected("radius", radius);
    array("velocity", 3, double{}, [&](const Particle& p) { return three(p.v); });
    array("angular velocity", 3, double{}, [&](const Particle& p) { return three(p.omega); });
    // Order e0, e1, e2, e3, as vtkGlyph3DMapper (representation 3D Glyphs) expects quaternions
    if (world.has_orientation()) array("orientation", 4, double{}, [](const Particle& p) { return p.e; });
    collected("material", material), collected("id", id);
    if (groups != nullptr) collected("group", group);
    if (clumps) collected("clump", clump);
    file.section("Points");
    array("Points", 3, double{}, [&](const Particle& p) { return three(p.r); });
    world.each_particle([&](const Particle& p) {
        radius.push_back(static_cast<float>(p.radius));
        material.push_back(static_cast<std::int32_t>(p.material)),
            id.push_back(static_cast<std::int32_t>(p.id));
        if (groups != nullptr) group.push_back(static_cast<std::int32_t>(groups->of(p.id)));
        if (clumps) clump.push_back(static_cast<std::int32_t>(p.clump));
    });
    file.write(append_piece);
}

std::array<double, 9> stress(const World& world, const std::vector<ContactRecord>& contacts, double volume)
{
    std::array<double, 9> sum{};
    const std::vector<Particle> all = world.particles();
    for (const ContactRecord& c : contacts) {
        // length of the branch vector of two spheres, which is parallel to n
        const double length =
            all[index_of(c.i, all)].radius + (c.boundary ? 0 : all[index_of(c.j, all)].radius) - c.delta;
        Vec3 branch = length * c.n - world.offset_in_clump(c.i);
        if (!c.boundary) branch += world.offset_in_clump(c.j);
        const double l[] = {branch.x, branch.y, branch.z}, F[] = {c.F.x, c.F.y, c.F.z};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) sum[3 * a + b] += l[a] * F[b] / volume;
    }
    return sum;
}

}  // namespace hilda::granular
