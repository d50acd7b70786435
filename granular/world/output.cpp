// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/output.hpp"

#include <charconv>
#include <cstring>
#include <span>

namespace hilda::granular {

namespace {

void append(std::string& to, double value)
{
    char digits[32];
    to.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}
void append(std::string& to, const Vec3& v)
{
    for (const double c : {v.x, v.y, v.z}) {
        to += ',';
        append(to, c);
    }
}

}  // namespace

std::string particles_csv(const World& world)
{
    const bool orientation = world.has_orientation();
    std::string csv = "id,material,radius,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z";
    csv += orientation ? ",e0,e1,e2,e3\n" : "\n";
    csv.reserve((orientation ? 300 : 220) * world.count());
    std::size_t id = 0;
    for (const Particle& p : world.particles()) {
        csv += std::to_string(id++) + ',' + std::to_string(p.material) + ',';
        append(csv, p.radius);
        append(csv, p.r), append(csv, p.v), append(csv, p.omega);
        for (std::size_t k = 0; orientation && k < 4; ++k) csv += ',', append(csv, p.e[k]);
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
        append(csv, c.delta);
        append(csv, c.F), append(csv, c.u);
        csv += '\n';
    }
    return csv;
}

std::string particles_vtp(const World& world)
{
    const std::vector<Particle> all = world.particles();
    std::string blocks, arrays;
    const auto add = [&](const char* section, const char* type, const char* name, int components,
                         const auto& values) {
        arrays += std::string(section) + "<DataArray type=\"" + type + "\" Name=\"" + name +
                  "\" NumberOfComponents=\"" + std::to_string(components) +
                  "\" format=\"appended\" offset=\"" + std::to_string(blocks.size()) + "\"/>\n";
        const auto bytes = std::as_bytes(std::span(values));
        const auto size = static_cast<std::uint64_t>(bytes.size());
        blocks.append(reinterpret_cast<const char*>(&size), sizeof size);
        blocks.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    std::vector<float> radius;
    std::vector<double> r, v, omega, e;
    std::vector<std::int32_t> material, id;
    for (const Particle& p : all) {
        id.push_back(static_cast<std::int32_t>(id.size()));
        radius.push_back(static_cast<float>(p.radius)), material.push_back(p.material);
        r.insert(r.end(), {p.r.x, p.r.y, p.r.z});
        v.insert(v.end(), {p.v.x, p.v.y, p.v.z});
        omega.insert(omega.end(), {p.omega.x, p.omega.y, p.omega.z});
        e.insert(e.end(), p.e.begin(), p.e.end());
    }
    add("<PointData>\n", "Float32", "radius", 1, radius);
    add("", "Float64", "velocity", 3, v);
    add("", "Float64", "angular velocity", 3, omega);
    // Order e0, e1, e2, e3, as vtkGlyph3DMapper (representation 3D Glyphs) expects quaternions
    if (world.has_orientation()) add("", "Float64", "orientation", 4, e);
    add("", "Int32", "material", 1, material);
    add("", "Int32", "id", 1, id);
    add("</PointData>\n<Points>\n", "Float64", "Points", 3, r);
    arrays += "</Points>\n";
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
           "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"" +
           std::to_string(all.size()) + "\">\n" + arrays +
           "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + blocks +
           "\n</AppendedData>\n</VTKFile>\n";
}

std::string pvd(const std::vector<std::pair<double, std::string>>& frames)
{
    std::string xml =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
        "byte_order=\"LittleEndian\">\n<Collection>\n";
    for (const auto& [t, file] : frames) {
        xml += "<DataSet timestep=\"";
        append(xml, t);
        xml += "\" file=\"" + file + "\"/>\n";
    }
    return xml + "</Collection>\n</VTKFile>\n";
}

std::array<double, 9> stress(const World& world, const std::vector<ContactRecord>& contacts, double volume)
{
    std::array<double, 9> sum{};
    const std::vector<Particle> all = world.particles();
    for (const ContactRecord& c : contacts) {
        // length of the branch vector, which is parallel to n
        const double length = all[c.i].radius + (c.boundary ? 0 : all[c.j].radius) - c.delta;
        const double l[] = {length * c.n.x, length * c.n.y, length * c.n.z}, F[] = {c.F.x, c.F.y, c.F.z};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) sum[3 * a + b] += l[a] * F[b] / volume;
    }
    return sum;
}

}  // namespace hilda::granular
