// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/boundary_drawing.hpp"

#include "granular/world/world.hpp"
#include "io/formats/vtk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr int around = 48, down = 24;  // divisions of a circle, of a half circle
constexpr double pi = std::numbers::pi;

struct Frame {
    Vec3 u, v, axis;  // right-handed, orthonormal

    explicit Frame(const Vec3& axis) : axis(axis)
    {
        const Vec3 other = std::abs(axis.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        u = axis.cross(other);
        u = (1 / u.norm()) * u;
        v = axis.cross(u);
    }
    Vec3 direction(double angle) const { return std::cos(angle) * u + std::sin(angle) * v; }
};

/// The part of a convex polygon where n · p <= d
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Vec3& n, double d)
{
    std::vector<Vec3> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        const double at_p = n.dot(p) - d, at_q = n.dot(q) - d;
        if (at_p <= 0) kept.push_back(p);
        if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0))
            kept.push_back(p + (at_p / (at_p - at_q)) * (q - p));
    }
    return kept;
}

Polygons plane(const Boundary& b, const Vec3& low, const Vec3& high)
{
    const Frame frame(b.axis);
    const Vec3 middle = 0.5 * (low + high), foot = middle - (middle - b.r).dot(b.axis) * b.axis;
    const double size = 2 * (high - low).norm();
    Polygons all;
    all.point = {foot - size * frame.u - size * frame.v, foot + size * frame.u - size * frame.v,
                 foot + size * frame.u + size * frame.v, foot - size * frame.u + size * frame.v};
    // A plane in a side of the domain is drawn in spite of rounding errors.
    const double rounding = 1e-9 * size;
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        all.point = clipped(all.point, axis, axis.dot(high) + rounding);
        all.point = clipped(all.point, -1. * axis, rounding - axis.dot(low));
    }
    if (all.point.size() < 3) return {};
    all.polygon.emplace_back();
    for (std::size_t k = 0; k < all.point.size(); ++k) all.polygon.back().push_back(static_cast<int>(k));
    return all;
}

/// A surface of revolution about the axis of b through rings of these radii at these distances from b.r. Seen
/// from outside the polygons are counterclockwise.
Polygons revolution(const Boundary& b, const std::vector<std::pair<double, double>>& rings)
{
    const Frame frame(b.axis);
    Polygons all;
    for (const auto& [along, radius] : rings)
        for (int k = 0; k < around; ++k)
            all.point.push_back(b.r + along * b.axis + radius * frame.direction(2 * pi * k / around));
    for (int ring = 0; ring + 1 < static_cast<int>(rings.size()); ++ring)
        for (int k = 0; k < around; ++k) {
            const int next = (k + 1) % around, first = ring * around, second = first + around;
            all.polygon.push_back({first + k, first + next, second + next, second + k});
        }
    return all;
}

/// Smallest and largest distance of the corners of the domain from b.r along the axis
std::pair<double, double> extent(const Boundary& b, const Vec3& low, const Vec3& high)
{
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p = {(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                        (corner & 4) != 0 ? high.z : low.z};
        const double along = (p - b.r).dot(b.axis);
        least = std::min(least, along), most = std::max(most, along);
    }
    return {least, most};
}

/// The triangles of the mesh of boundary number `of`
Polygons mesh_drawing(const Boundary& b, const Meshes& meshes, std::uint32_t of)
{
    Polygons all;
    const Meshes::Part* const part = meshes.part_of(of);
    if (part == nullptr) return all;
    for (std::uint32_t v = part->first_vertex; v < part->end_vertex; ++v)
        all.point.push_back(b.r + rotated(b.p, meshes.vertex[v]));
    for (std::uint32_t t = part->first; t < part->end; ++t) {
        all.polygon.emplace_back();
        for (const std::uint32_t v : meshes.triangle[t].vertex)
            all.polygon.back().push_back(static_cast<int>(v - part->first_vertex));
    }
    return all;
}

}  // namespace

Polygons drawing(const Boundary& b, const Vec3& low, const Vec3& high)
{
    if (b.shape == Boundary::Shape::plane) return plane(b, low, high);
    if (b.shape == Boundary::Shape::none) return {};
    std::vector<std::pair<double, double>> rings;
    const auto [least, most] = extent(b, low, high);
    if (b.shape == Boundary::Shape::frustum) {
        const bool has_faces = b.inside == 0;
        if (has_faces && (b.flags & open_first_end) == 0) rings.emplace_back(b.from, 0);
        rings.emplace_back(b.from, b.radius), rings.emplace_back(b.to, b.second_radius);
        if (has_faces && (b.flags & open_second_end) == 0) rings.emplace_back(b.to, 0);
    } else if (b.shape == Boundary::Shape::disk) {
        rings = {{0, b.radius}, {0, 0}};
    } else if (b.shape == Boundary::Shape::torus) {
        for (int k = 0; k <= down; ++k) {
            const double angle = 2 * pi * k / down;
            rings.emplace_back(-b.radius * std::cos(angle), b.second_radius + b.radius * std::sin(angle));
        }
    } else if (b.shape == Boundary::Shape::cylinder) {
        rings = {{least, b.radius}, {most, b.radius}};
    } else if (b.shape == Boundary::Shape::cone) {
        if (most <= 0) return {};
        const double first = std::max(0., least), slope = b.sine / b.cosine;
        rings = {{first, slope * first}, {most, slope * most}};
    } else {
        for (int k = 0; k <= down; ++k)
            rings.emplace_back(-b.radius * std::cos(pi * k / down), b.radius * std::sin(pi * k / down));
    }
    Polygons all = revolution(b, rings);
    if (b.inside != 0)
        for (std::vector<int>& polygon : all.polygon) std::reverse(polygon.begin(), polygon.end());
    return all;
}

std::string boundaries_vtp(const World& world)
{
    std::vector<double> points, velocities;
    std::vector<std::int32_t> number, connectivity, offsets;
    int count = 0;
    for (std::size_t k = 0; k < world.all_boundaries().size(); ++k) {
        const Boundary& b = world.all_boundaries()[k];
        const Polygons drawn = b.shape == Boundary::Shape::mesh
                                   ? mesh_drawing(b, world.all_meshes(), static_cast<std::uint32_t>(k))
                                   : drawing(b, world.low(), world.high());
        for (const Vec3& p : drawn.point) {
            const Vec3 v = b.v + b.omega.cross(p - b.r);
            points.insert(points.end(), {p.x, p.y, p.z});
            velocities.insert(velocities.end(), {v.x, v.y, v.z});
        }
        for (const std::vector<int>& polygon : drawn.polygon) {
            for (const int vertex : polygon) connectivity.push_back(count + vertex);
            offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
            number.push_back(static_cast<std::int32_t>(k));
        }
        count += static_cast<int>(drawn.point.size());
    }
    io::VtkPolyData file({{"NumberOfPoints", static_cast<std::size_t>(count)},
                          {"NumberOfVerts", 0},
                          {"NumberOfLines", 0},
                          {"NumberOfStrips", 0},
                          {"NumberOfPolys", offsets.size()}});
    file.section("PointData");
    file.array("velocity", 3, velocities);
    file.section("CellData");
    file.array("boundary", 1, number);
    file.section("Points");
    file.array("Points", 3, points);
    file.section("Polys");
    file.array("connectivity", 1, connectivity);
    file.array("offsets", 1, offsets);
    return file.text();
}

}  // namespace hilda::granular
