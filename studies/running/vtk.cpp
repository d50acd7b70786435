// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/vtk.hpp"

#include "dae/body.hpp"
#include "io/csv.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace hilda::studies {

namespace {

using lie::Motion;
using lie::Vec3;

const Motion& motion(const std::vector<Motion>& bodies, int b)
{
    static const Motion at_rest;
    return b < 0 ? at_rest : bodies[b];
}

std::string escaped(const std::string& name)
{
    constexpr std::string_view special = "&<>\"";
    constexpr std::string_view as[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
    std::string xml;
    for (const char& c : name) {
        const size_t k = special.find(c);
        xml += k < special.size() ? as[k] : std::string_view(&c, 1);
    }
    return xml;
}

std::string frame_file(const std::string& name, size_t k) { return fmt::format("vtk/{}-{:06}.vtp", name, k); }

/// A <DataArray> element
template <class Number>
struct Array {
    std::string name;
    int components;
    std::string text = {};

    void add(Number x)
    {
        char digits[32];
        text.append(digits, std::to_chars(digits, digits + sizeof digits, x).ptr) += ' ';
    }
    void add(const Vec3& v)
    {
        constexpr double least = std::numeric_limits<Number>::min();  // some readers fail at denormal numbers
        for (const double x : v) add(std::abs(x) < least ? 0 : static_cast<Number>(x));
    }
    std::string xml() const
    {
        return fmt::format(
            "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n{}\n"
            "</DataArray>\n",
            std::is_integral_v<Number> ? "Int32" : "Float32", name, components, text);
    }
};
using Numbers = Array<int>;
using Vectors = Array<float>;

/// Cells, by the numbers of their points
struct Cells {
    Numbers connectivity = {"connectivity", 1}, offsets = {"offsets", 1};
    int count = 0, ends = 0;

    void add(const std::vector<int>& points, int first)
    {
        for (const int k : points) connectivity.add(first + k);
        offsets.add(ends += static_cast<int>(points.size()));
        ++count;
    }
    std::string xml() const { return connectivity.xml() + offsets.xml(); }
};

}  // namespace

bool EvenSelection::is_selected(long n)
{
    if (selected == count || n != next()) return false;
    while (selected < count && next() <= n) ++selected;
    return true;
}

long EvenSelection::next() const
{
    return count == 1 ? 0 : std::lround(static_cast<double>(steps) * selected / (count - 1));
}

void Snapshots::add_surface(int body, const contact::Shape& shape)
{
    const auto same = [&](const BodySurface& s) {
        return s.body == body && s.shape.surface == shape.surface && s.shape.position == shape.position &&
               s.shape.orientation == shape.orientation;
    };
    if (std::none_of(surfaces.begin(), surfaces.end(), same)) surfaces.push_back({body, shape});
}

Snapshots::ContactData Snapshots::contact_data(int contact, int i, const contact::ContactState& now,
                                               const contact::Wrench& friction,
                                               const contact::Deflections& history)
{
    return {.contact = contact,
            .i = i,
            .C = now.contact_point.C(),
            .N = now.N * now.contact_point.n,
            .F = friction.F,
            .slipping = history.slide.slipping,
            .rolling = history.roll_i.slipping || history.roll_j.slipping};
}

void Snapshots::add(double t, std::vector<Motion> bodies, std::vector<ContactData> contacts)
{
    frames.push_back({t, std::move(bodies), std::move(contacts)});
}

/// Region, in the frame of the surface, of the bounding spheres of the surfaces of other bodies and of the
/// contact points, over all frames
DrawingExtent Snapshots::extent_of(const BodySurface& of, const std::vector<double>& radius) const
{
    DrawingExtent extent;
    Eigen::AlignedBox3d whole;
    for (const Frame& now : frames) {
        const Motion& own = motion(now.body, of.body);
        const auto visit = [&](const Vec3& p, double R) {
            const Vec3 a = of.shape.to_surface(own.A.transpose() * (p - own.r));
            for (const double sign : {-R, R}) {
                extent.box.extend(a + Vec3::Constant(sign));
                whole.extend(p + Vec3::Constant(sign));
            }
        };
        for (size_t k = 0; k < surfaces.size(); ++k) {
            if (surfaces[k].body == of.body || !(radius[k] > 0)) continue;
            const Motion& b = motion(now.body, surfaces[k].body);
            visit(b.r + b.A * surfaces[k].shape.position, radius[k]);
        }
        for (const ContactData& t : now.contacts) visit(t.C, 0);
    }
    if (!whole.isEmpty()) extent.scene_size = whole.diagonal().norm();
    return extent;
}

std::vector<Snapshots::BodyMesh> Snapshots::body_meshes() const
{
    const auto piece = [](const BodySurface& s, const DrawingExtent& extent) {
        BodyMesh p{s.body, tessellate(*s.shape.surface, extent)};
        for (Vec3& a : p.mesh.point) a = s.shape.to_body(a);
        return p;
    };
    std::vector<double> radius(surfaces.size(),
                               0);  // about the origin of the surface; 0 for unbounded surfaces
    for (size_t k = 0; k < surfaces.size(); ++k)
        if (!surfaces[k].shape.surface->is_unbounded())
            for (const Vec3& a : tessellate(*surfaces[k].shape.surface, {}).point)
                radius[k] = std::max(radius[k], a.norm());
    std::vector<BodyMesh> all;
    for (const BodySurface& s : surfaces) {
        BodyMesh p = piece(s, s.shape.surface->is_unbounded() ? extent_of(s, radius) : DrawingExtent());
        if (std::find(all.begin(), all.end(), p) == all.end()) all.push_back(std::move(p));
    }
    return all;
}

std::string Snapshots::poly_data(const Frame& now, const std::vector<BodyMesh>& body_meshes)
{
    Vectors points{"Points", 3}, velocities{"velocity", 3}, N{"normal_force", 3}, F{"friction", 3};
    Numbers slipping{"slipping", 1}, rolling{"rolling", 1}, body{"body", 1}, contact{"contact", 1};
    Cells vertices, polygons;  // VTK expects cell data in this order
    int count = 0;
    for (const ContactData& t : now.contacts) {
        points.add(t.C);
        const Motion& b = motion(now.body, t.i);
        velocities.add(dae::velocity_at(b, t.C - b.r));
        N.add(t.N);
        F.add(t.F);
        slipping.add(t.slipping);
        rolling.add(t.rolling);
        body.add(t.i);
        contact.add(t.contact);
        vertices.add({0}, count++);
    }
    for (const BodyMesh& piece : body_meshes) {
        const Motion& b = motion(now.body, piece.body);
        for (const Vec3& a : piece.mesh.point) {
            const Vec3 p = b.r + b.A * a;
            points.add(p);
            velocities.add(dae::velocity_at(b, p - b.r));
            N.add(Vec3::Zero());
            F.add(Vec3::Zero());
            slipping.add(0);
            rolling.add(0);
        }
        for (const std::vector<int>& polygon : piece.mesh.polygon) {
            body.add(piece.body);
            contact.add(-1);
            polygons.add(polygon, count);
        }
        count += static_cast<int>(piece.mesh.point.size());
    }
    return fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n"
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
        "NumberOfPolys=\"{}\">\n"
        "<PointData>\n{}{}{}{}{}</PointData>\n<CellData>\n{}{}</CellData>\n<Points>\n{}</Points>\n"
        "<Verts>\n{}</Verts>\n<Polys>\n{}</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        count, vertices.count, polygons.count, velocities.xml(), N.xml(), F.xml(), slipping.xml(),
        rolling.xml(), body.xml(), contact.xml(), points.xml(), vertices.xml(), polygons.xml());
}

void Snapshots::write(const std::string& directory, const std::string& name) const
{
    io::make_directory(directory + "/vtk");
    const std::vector<BodyMesh> all = body_meshes();
    std::string list =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for (size_t k = 0; k < frames.size(); ++k) {
        const std::string file = frame_file(name, k);
        io::write_file(directory + '/' + file, poly_data(frames[k], all));
        list += "<DataSet timestep=\"";
        io::append_number(list, frames[k].t);
        list += "\" part=\"0\" file=\"" + escaped(file) + "\"/>\n";
    }
    io::write_file(directory + '/' + name + ".pvd", list + "</Collection>\n</VTKFile>\n");
}

void Snapshots::remove(const std::string& directory, const std::string& name)
{
    std::remove((directory + '/' + name + ".pvd").c_str());
    for (size_t k = 0; std::remove((directory + '/' + frame_file(name, k)).c_str()) == 0;) ++k;
}

}  // namespace hilda::studies
