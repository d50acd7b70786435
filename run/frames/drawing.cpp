// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/frames/drawing.hpp"

#include "io/formats/vtk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::run {

namespace {

using lie::Motion;
using lie::Vec3;

/// The components of vectors. Some readers fail at denormal numbers.
struct Vectors {
    std::vector<float> components;

    void add(const Vec3& v)
    {
        for (const double x : v)
            components.push_back(std::abs(x) < std::numeric_limits<float>::min() ? 0 : static_cast<float>(x));
    }
};

/// Cells, by the numbers of their points
struct Cells {
    std::vector<int> connectivity, offsets;

    void add(const std::vector<int>& points, int first)
    {
        for (const int k : points) connectivity.push_back(first + k);
        offsets.push_back(static_cast<int>(connectivity.size()));
    }
    void write(const char* section, io::VtkPolyData& to) const
    {
        to.section(section);
        to.array("connectivity", 1, connectivity);
        to.array("offsets", 1, offsets);
    }
};

}  // namespace

const lie::Motion& motion(const std::vector<lie::Motion>& bodies, int body)
{
    static const lie::Motion at_rest;
    return body < 0 ? at_rest : bodies[body];
}

void Drawing::add_surface(int body, const contact::Shape& shape)
{
    const auto same = [&](const BodySurface& s) {
        return s.shape.surface == shape.surface && s.shape.position == shape.position &&
               s.shape.orientation == shape.orientation;
    };
    std::vector<size_t>& of_body = surfaces_of_body[body];
    if (std::any_of(of_body.begin(), of_body.end(), [&](size_t k) { return same(surfaces[k]); })) return;
    of_body.push_back(surfaces.size());
    surfaces.push_back({body, shape});
}

void Drawing::add_joint(int body, const Vec3& s_bar)
{
    const Joint joint{body, s_bar};
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) joints.push_back(joint);
}

Drawing::ContactData Drawing::contact_data(int contact, int i, const contact::ContactState& now,
                                           const contact::Wrench& friction,
                                           const contact::Deflections& history)
{
    return {.contact = contact,
            .i = i,
            .C = now.contact_point.C(),
            .N = now.N * now.contact_point.n,
            .F = friction.F,
            .slipping = history.slide.slipping,
            .rolling = history.roll_i.slipping || history.roll_j.slipping,
            .u = now.slip.u};
}

void Drawing::Frame::transfer(io::Archive& a)
{
    a.value(t);
    a.list(body);
    size_t count = contacts.size();
    a.count(count, 2 * sizeof(int));
    contacts.resize(count);
    for (ContactData& c : contacts) {
        a.value(c.contact), a.value(c.i), a.value(c.slipping), a.value(c.rolling);
        for (Vec3* v : {&c.C, &c.N, &c.F})
            for (double& x : *v) a.value(x);
        a.check(c.i >= -1 && c.i < static_cast<int>(body.size()), "unknown body in a frame");
    }
}

namespace {

/// The points and cells of a frame, in the order in which VTK expects them: vertices, lines, polygons
struct FrameData {
    Vectors points, velocities, N, F;
    std::vector<int> slipping, rolling, body, contact, kind;
    Cells vertices, lines, polygons;
    int count = 0;  ///< of the points

    /// Adds the material point p of a body.
    void add_point(const Vec3& p, const Motion& b)
    {
        points.add(p);
        velocities.add(dae::velocity_at(b, p - b.r));
        N.add(Vec3::Zero()), F.add(Vec3::Zero());
        slipping.push_back(0), rolling.push_back(0);
        ++count;
    }
    /// Adds the values of a cell.
    void add_cell(int of_body, int of_contact, int of_kind)
    {
        body.push_back(of_body), contact.push_back(of_contact), kind.push_back(of_kind);
    }

    std::string text() const
    {
        io::VtkPolyData file({{"NumberOfPoints", static_cast<size_t>(count)},
                              {"NumberOfVerts", vertices.offsets.size()},
                              {"NumberOfLines", lines.offsets.size()},
                              {"NumberOfStrips", 0},
                              {"NumberOfPolys", polygons.offsets.size()}});
        file.section("PointData");
        file.array("velocity", 3, velocities.components);
        file.array("normal_force", 3, N.components);
        file.array("friction", 3, F.components);
        file.array("slipping", 1, slipping);
        file.array("rolling", 1, rolling);
        file.section("CellData");
        file.array("body", 1, body);
        file.array("contact", 1, contact);
        file.array("kind", 1, kind);
        file.section("Points");
        file.array("Points", 3, points.components);
        vertices.write("Verts", file);
        lines.write("Lines", file);
        polygons.write("Polys", file);
        return file.text();
    }
};

}  // namespace

std::string Drawing::poly_data(const Frame& now, const std::vector<BodyMesh>& meshes) const
{
    FrameData data;
    for (const ContactData& t : now.contacts) {
        data.vertices.add({0}, data.count++);
        data.points.add(t.C);
        const Motion& b = motion(now.body, t.i);
        data.velocities.add(dae::velocity_at(b, t.C - b.r));
        data.N.add(t.N), data.F.add(t.F);
        data.slipping.push_back(t.slipping), data.rolling.push_back(t.rolling);
        data.add_cell(t.i, t.contact, contact_point);
    }
    for (const Joint& at : joints) {
        const Motion& b = motion(now.body, at.body);
        data.vertices.add({0}, data.count);
        data.add_point(b.r + b.A * at.s_bar, b);
        data.add_cell(at.body, -1, joint);
    }
    for (const Line& line : lines) {
        const Motion &bi = motion(now.body, line.ends.i), &bj = motion(now.body, line.ends.j);
        data.lines.add({0, 1}, data.count);
        data.add_point(bi.r + bi.A * line.ends.s_bar_i, bi);
        data.add_point(bj.r + bj.A * line.ends.s_bar_j, bj);
        data.add_cell(line.ends.i, -1, line.kind);
    }
    for (const BodyMesh& piece : meshes) {
        const Motion& b = motion(now.body, piece.body);
        const int first = data.count;
        for (const Vec3& a : piece.mesh.point) data.add_point(b.r + b.A * a, b);
        for (const std::vector<int>& polygon : piece.mesh.polygon) {
            data.polygons.add(polygon, first);
            data.add_cell(piece.body, -1, piece.kind);
        }
    }
    return data.text();
}

namespace {

io::Json point_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

io::Json Drawing::geometry(const std::vector<BodyMesh>& meshes) const
{
    static const std::vector<std::string> kinds = {"contact", "joint",   "spring", "link",
                                                   "solid",   "surface", "bar"};
    io::Json all = {
        {"meshes", io::Json::array()}, {"joints", io::Json::array()}, {"lines", io::Json::array()}};
    for (const BodyMesh& of : meshes) {
        io::Json points = io::Json::array();
        for (const Vec3& p : of.mesh.point) points.push_back(point_of(p));
        all["meshes"].push_back({{"body", of.body},
                                 {"kind", kinds[of.kind]},
                                 {"unbounded", of.is_unbounded},
                                 {"points", std::move(points)},
                                 {"polygons", of.mesh.polygon}});
    }
    for (const Joint& at : joints)
        all["joints"].push_back({{"body", at.body}, {"point", point_of(at.s_bar)}});
    for (const Line& line : lines)
        all["lines"].push_back({{"kind", kinds[line.kind]},
                                {"body_i", line.ends.i},
                                {"point_i", point_of(line.ends.s_bar_i)},
                                {"body_j", line.ends.j},
                                {"point_j", point_of(line.ends.s_bar_j)}});
    return all;
}

}  // namespace hilda::run
