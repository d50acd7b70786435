// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/vtk.hpp"

#include "studies/csv.hpp"
#include "studies/output.hpp"

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

Vec3 velocity(const Motion& b, const Vec3& p) { return b.rdot + (b.A * b.omega_bar).cross(p - b.r); }

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

/// The numbers of a <DataArray>
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
        constexpr double least = std::numeric_limits<Number>::min();  // some readers stop at smaller ones
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

/// Cells, by the points that they have
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

bool EvenChoice::takes(long n)
{
    if (selected == count || n != next()) return false;
    while (selected < count && next() <= n) ++selected;
    return true;
}

long EvenChoice::next() const
{
    return count == 1 ? 0 : std::lround(static_cast<double>(steps) * selected / (count - 1));
}

void Snapshots::show(int body, const contact::Shape& shape)
{
    const auto same = [&](const Shown& s) {
        return s.body == body && s.shape.surface == shape.surface && s.shape.position == shape.position &&
               s.shape.orientation == shape.orientation;
    };
    if (std::none_of(shown.begin(), shown.end(), same)) shown.push_back({body, shape});
}

Snapshots::ContactPoint Snapshots::contact_point(int contact, int i, const contact::ContactState& now,
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

void Snapshots::add(double t, std::vector<Motion> bodies, std::vector<ContactPoint> touches)
{
    instants.push_back({t, std::move(bodies), std::move(touches)});
}

/// In the frame of the surface: the balls around the surfaces of other bodies, and the contact points
Reach Snapshots::reach(const Shown& of, const std::vector<double>& radius) const
{
    Reach reach;
    Eigen::AlignedBox3d whole;
    for (const Instant& now : instants) {
        const Motion& own = motion(now.body, of.body);
        const auto visit = [&](const Vec3& p, double R) {
            const Vec3 a = of.shape.to_surface(own.A.transpose() * (p - own.r));
            for (const double sign : {-R, R}) {
                reach.box.extend(a + Vec3::Constant(sign));
                whole.extend(p + Vec3::Constant(sign));
            }
        };
        for (size_t k = 0; k < shown.size(); ++k) {
            if (shown[k].body == of.body || !(radius[k] > 0)) continue;
            const Motion& b = motion(now.body, shown[k].body);
            visit(b.r + b.A * shown[k].shape.position, radius[k]);
        }
        for (const ContactPoint& t : now.contact_point) visit(t.C, 0);
    }
    if (!whole.isEmpty()) reach.motion = whole.diagonal().norm();
    return reach;
}

std::vector<Snapshots::Piece> Snapshots::pieces() const
{
    const auto piece = [](const Shown& s, const Reach& reach) {
        Piece p{s.body, tessellated(*s.shape.surface, reach)};
        for (Vec3& a : p.mesh.point) a = s.shape.to_body(a);
        return p;
    };
    std::vector<double> radius(shown.size(), 0);  // about the origin of the surface; none without end
    for (size_t k = 0; k < shown.size(); ++k)
        if (!endless(*shown[k].shape.surface))
            for (const Vec3& a : tessellated(*shown[k].shape.surface, {}).point)
                radius[k] = std::max(radius[k], a.norm());
    std::vector<Piece> all;
    for (const Shown& s : shown) {
        Piece p = piece(s, endless(*s.shape.surface) ? reach(s, radius) : Reach());
        if (std::find(all.begin(), all.end(), p) == all.end()) all.push_back(std::move(p));
    }
    return all;
}

std::string Snapshots::poly_data(const Instant& now, const std::vector<Piece>& pieces)
{
    Vectors points{"Points", 3}, velocities{"velocity", 3}, N{"normal_force", 3}, F{"friction", 3};
    Numbers slipping{"slipping", 1}, rolling{"rolling", 1}, body{"body", 1}, contact{"contact", 1};
    Cells vertices, polygons;  // in this order VTK takes the data of cells
    int count = 0;
    for (const ContactPoint& t : now.contact_point) {
        points.add(t.C);
        velocities.add(velocity(motion(now.body, t.i), t.C));
        N.add(t.N);
        F.add(t.F);
        slipping.add(t.slipping);
        rolling.add(t.rolling);
        body.add(t.i);
        contact.add(t.contact);
        vertices.add({0}, count++);
    }
    for (const Piece& piece : pieces) {
        const Motion& b = motion(now.body, piece.body);
        for (const Vec3& a : piece.mesh.point) {
            const Vec3 p = b.r + b.A * a;
            points.add(p);
            velocities.add(velocity(b, p));
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
    make_directory(directory + "/vtk");
    const std::vector<Piece> all = pieces();
    std::string list =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for (size_t k = 0; k < instants.size(); ++k) {
        const std::string file = frame_file(name, k);
        write_file(directory + '/' + file, poly_data(instants[k], all));
        list += "<DataSet timestep=\"";
        append_number(list, instants[k].t);
        list += "\" part=\"0\" file=\"" + escaped(file) + "\"/>\n";
    }
    write_file(directory + '/' + name + ".pvd", list + "</Collection>\n</VTKFile>\n");
}

void Snapshots::remove(const std::string& directory, const std::string& name)
{
    std::remove((directory + '/' + name + ".pvd").c_str());
    for (size_t k = 0; std::remove((directory + '/' + frame_file(name, k)).c_str()) == 0;) ++k;
}

}  // namespace hilda::studies
