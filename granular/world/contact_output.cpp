// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/contact_output.hpp"

#include "io/formats/csv.hpp"
#include "io/formats/vtk.hpp"
#include "io/message.hpp"

namespace hilda::granular {

namespace {

double normal_force(const ContactRecord& c) { return c.F.dot(c.n); }
Vec3 tangential_force(const ContactRecord& c) { return c.F - normal_force(c) * c.n; }

}  // namespace

std::string contact_list_header() { return "t,i,j,boundary,x,y,z,nx,ny,nz,overlap,Fn,Ftx,Fty,Ftz\n"; }

void contact_list_csv(std::string& text, double t, const std::vector<ContactRecord>& contacts)
{
    const std::string time = io::formatted("%.12g", t);
    const auto append = [&](double x) { text += ',', io::append_number(text, x); };
    const auto append_vector = [&](const Vec3& v) { append(v.x), append(v.y), append(v.z); };
    for (const ContactRecord& c : contacts) {
        text += time + ',' + std::to_string(c.i) + ',' + std::to_string(c.j) + ',' + (c.boundary ? '1' : '0');
        append_vector(c.C), append_vector(c.n);
        append(c.delta), append(normal_force(c)), append_vector(tangential_force(c));
        text += '\n';
    }
}

std::string contact_network_vtp(const World& world, const std::vector<ContactRecord>& contacts)
{
    const std::vector<Particle> all = world.particles();
    std::vector<double> points, normal, tangential, overlap;
    std::vector<std::int32_t> boundary, i, j, connectivity, offsets;
    for (const ContactRecord& c : contacts) {
        const Particle& p = all[index_of(c.i, all)];
        const double length = p.radius - c.delta + (c.boundary ? 0 : all[index_of(c.j, all)].radius);
        for (const Vec3& end : {p.r, p.r - length * c.n}) {
            connectivity.push_back(static_cast<std::int32_t>(points.size() / 3));
            points.insert(points.end(), {end.x, end.y, end.z});
        }
        offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
        normal.push_back(normal_force(c)), tangential.push_back(tangential_force(c).norm());
        overlap.push_back(c.delta), boundary.push_back(c.boundary ? 1 : 0);
        i.push_back(static_cast<std::int32_t>(c.i)), j.push_back(static_cast<std::int32_t>(c.j));
    }
    io::VtkPolyData file({{"NumberOfPoints", points.size() / 3},
                          {"NumberOfVerts", 0},
                          {"NumberOfLines", offsets.size()},
                          {"NumberOfStrips", 0},
                          {"NumberOfPolys", 0}});
    file.section("CellData");
    file.array("normal force", 1, normal);
    file.array("tangential force", 1, tangential);
    file.array("overlap", 1, overlap);
    file.array("boundary", 1, boundary);
    file.array("i", 1, i);
    file.array("j", 1, j);
    file.section("Points");
    file.array("Points", 3, points);
    file.section("Lines");
    file.array("connectivity", 1, connectivity);
    file.array("offsets", 1, offsets);
    return file.text();
}

}  // namespace hilda::granular
