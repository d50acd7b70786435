// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/output.hpp"

#include "io/csv.hpp"
#include "io/vtk.hpp"

namespace hilda::granular {

namespace {

/// Appends the components, each preceded by a comma
void append(std::string& to, const Vec3& v)
{
    for (const double c : {v.x, v.y, v.z}) {
        to += ',';
        io::append_number(to, c);
    }
}

}  // namespace

std::string particles_csv(const World& world)
{
    const bool orientation = world.has_orientation();
    std::string csv = "id,material,radius,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z";
    csv += orientation ? ",e0,e1,e2,e3\n" : "\n";
    csv.reserve((orientation ? 300 : 220) * world.count());
    for (const Particle& p : world.particles()) {
        csv += std::to_string(p.id) + ',' + std::to_string(p.material) + ',';
        io::append_number(csv, p.radius);
        append(csv, p.r), append(csv, p.v), append(csv, p.omega);
        for (std::size_t k = 0; orientation && k < 4; ++k) csv += ',', io::append_number(csv, p.e[k]);
        csv += '\n';
    }
    return csv;
}

std::string contacts_csv(const World& world)
{
    std::string csv = "i,j,boundary,nx,ny,nz,overlap,Fx,Fy,Fz,ux,uy,uz\n";
    const std::vector<ContactRecord> all = world.contacts();
    csv.reserve(240 * all.size());
    for (const ContactRecord& c : all) {
        csv += std::to_string(c.i) + ',' + std::to_string(c.j) + ',' + (c.boundary ? '1' : '0');
        append(csv, c.n);
        csv += ',';
        io::append_number(csv, c.delta);
        append(csv, c.F), append(csv, c.u);
        csv += '\n';
    }
    return csv;
}

std::string particles_vtp(const World& world)
{
    std::vector<float> radius;
    std::vector<double> r, v, omega, e;
    std::vector<std::int32_t> material, id;
    for (const Particle& p : world.particles()) {
        id.push_back(static_cast<std::int32_t>(p.id));
        radius.push_back(static_cast<float>(p.radius)), material.push_back(p.material);
        r.insert(r.end(), {p.r.x, p.r.y, p.r.z});
        v.insert(v.end(), {p.v.x, p.v.y, p.v.z});
        omega.insert(omega.end(), {p.omega.x, p.omega.y, p.omega.z});
        e.insert(e.end(), p.e.begin(), p.e.end());
    }
    io::VtkPolyData file({{"NumberOfPoints", id.size()}});
    file.section("PointData");
    file.array("radius", 1, radius);
    file.array("velocity", 3, v);
    file.array("angular velocity", 3, omega);
    // Order e0, e1, e2, e3, as vtkGlyph3DMapper (representation 3D Glyphs) expects quaternions
    if (world.has_orientation()) file.array("orientation", 4, e);
    file.array("material", 1, material);
    file.array("id", 1, id);
    file.section("Points");
    file.array("Points", 3, r);
    return file.text();
}

std::array<double, 9> stress(const World& world, const std::vector<ContactRecord>& contacts, double volume)
{
    std::array<double, 9> sum{};
    const std::vector<Particle> all = world.particles();
    for (const ContactRecord& c : contacts) {
        // length of the branch vector, which is parallel to n
        const double length =
            all[index_of(c.i, all)].radius + (c.boundary ? 0 : all[index_of(c.j, all)].radius) - c.delta;
        const double l[] = {length * c.n.x, length * c.n.y, length * c.n.z}, F[] = {c.F.x, c.F.y, c.F.z};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) sum[3 * a + b] += l[a] * F[b] / volume;
    }
    return sum;
}

}  // namespace hilda::granular
