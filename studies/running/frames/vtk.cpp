// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/frames/vtk.hpp"

#include "io/files.hpp"
#include "io/vtk.hpp"

#include <fmt/format.h>

#include <algorithm>
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

std::string frame_file(const std::string& name, size_t k) { return fmt::format("vtk/{}-{:06}.vtp", name, k); }

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

void Snapshots::add_joint(int body, const Vec3& s_bar)
{
    const Joint joint{body, s_bar};
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) joints.push_back(joint);
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
            .rolling = history.roll_i.slipping || history.roll_j.slipping,
            .u = now.slip.u};
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
        BodyMesh p{s.body, tessellate(*s.shape.surface, extent), surface, s.shape.surface->is_unbounded()};
        for (Vec3& a : p.mesh.point) a = s.shape.to_body(a);
        return p;
    };
    std::vector<double> radius(surfaces.size(),
                               0);  // about the origin of the surface; 0 for unbounded surfaces
    for (size_t k = 0; k < surfaces.size(); ++k)
        if (!surfaces[k].shape.surface->is_unbounded())
            for (const Vec3& a : tessellate(*surfaces[k].shape.surface, {}).point)
                radius[k] = std::max(radius[k], a.norm());
    std::vector<BodyMesh> all = solids;
    for (const BodySurface& s : surfaces) {
        BodyMesh p = piece(s, s.shape.surface->is_unbounded() ? extent_of(s, radius) : DrawingExtent());
        if (std::find(all.begin(), all.end(), p) == all.end()) all.push_back(std::move(p));
    }
    return all;
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

std::string Snapshots::poly_data(const Frame& now, const std::vector<BodyMesh>& body_meshes) const
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
    for (const BodyMesh& piece : body_meshes) {
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

io::Json Snapshots::geometry() const
{
    static const std::vector<std::string> kinds = {"contact", "joint",   "spring", "link",
                                                   "solid",   "surface", "bar"};
    io::Json all = {
        {"meshes", io::Json::array()}, {"joints", io::Json::array()}, {"lines", io::Json::array()}};
    for (const BodyMesh& of : body_meshes()) {
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

void Snapshots::write(const std::string& directory, const std::string& name) const
{
    io::make_directory(directory + "/vtk");
    const std::vector<BodyMesh> all = body_meshes();
    std::vector<std::pair<double, std::string>> files;
    for (size_t k = 0; k < frames.size(); ++k) {
        files.emplace_back(frames[k].t, frame_file(name, k));
        io::write_file(directory + '/' + files.back().second, poly_data(frames[k], all));
    }
    io::write_file(directory + '/' + name + ".pvd", io::vtk_collection(files));
}

void Snapshots::transfer(io::Archive& a)
{
    size_t count = frames.size();
    a.count(count, sizeof(double));
    frames.resize(count);
    for (Frame& frame : frames) {
        a.value(frame.t);
        a.list(frame.body);
        for (const BodySurface& s : surfaces)
            a.check(s.body < static_cast<int>(frame.body.size()), "a frame with too few bodies");
        size_t contacts = frame.contacts.size();
        a.count(contacts, 2 * sizeof(int));
        frame.contacts.resize(contacts);
        for (ContactData& c : frame.contacts) {
            a.value(c.contact), a.value(c.i), a.value(c.slipping), a.value(c.rolling);
            for (Vec3* v : {&c.C, &c.N, &c.F})
                for (double& x : *v) a.value(x);
            a.check(c.i >= -1 && c.i < static_cast<int>(frame.body.size()), "unknown body in a frame");
        }
    }
}

void Snapshots::remove(const std::string& directory, const std::string& name)
{
    std::remove((directory + '/' + name + ".pvd").c_str());
    for (size_t k = 0; std::remove((directory + '/' + frame_file(name, k)).c_str()) == 0;) ++k;
}

}  // namespace hilda::studies
