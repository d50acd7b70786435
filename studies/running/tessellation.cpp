// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/tessellation.hpp"

#include "contact/mesh/height_map.hpp"
#include "contact/mesh/mesh_surface.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/torus.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

namespace hilda::studies {

namespace {

using contact::Surface;
using lie::Vec3;

constexpr int around = 24, down = 12,
              across = 8;           // numbers of divisions of a circle, of a half circle, of a patch
constexpr double margin = 1.1;      // size of a patch, relative to the region to be covered
constexpr double foot_size = 0.05;  // half side of a foot, relative to the size of the scene
constexpr double largest_distance =
    1e3;  // of a surface point from the origin, relative to the size of the surface
constexpr double pi = std::numbers::pi;

Vec3 missing_point() { return Vec3::Constant(std::numeric_limits<double>::quiet_NaN()); }

/// Quadrilaterals of a grid of points; rows and columns may be closed to rings. The normal is row direction ×
/// column direction.
void add_quads(Mesh& mesh, int first, int rows, int columns, bool rows_join, bool columns_join)
{
    const auto at = [&](int r, int c) { return first + r % rows * columns + c % columns; };
    for (int r = 0; r < rows - !rows_join; ++r)
        for (int c = 0; c < columns - !columns_join; ++c)
            mesh.polygon.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)});
}

/// Image of the unit sphere, with a grid of latitude and longitude about z
Mesh sphere_image(const std::function<Vec3(const Vec3&)>& image)
{
    Mesh mesh;
    mesh.point.push_back(image(Vec3::UnitZ()));
    for (int r = 1; r < down; ++r)
        for (int c = 0; c < around; ++c) {
            const double theta = pi * r / down, phi = 2 * pi * c / around;
            mesh.point.push_back(
                image({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}));
        }
    mesh.point.push_back(image(-Vec3::UnitZ()));
    const int last_ring = 1 + (down - 2) * around, south = last_ring + around;
    for (int c = 0; c < around; ++c) {
        const int next = (c + 1) % around;
        mesh.polygon.push_back({0, 1 + c, 1 + next});
        mesh.polygon.push_back({south, last_ring + next, last_ring + c});
    }
    add_quads(mesh, 1, down - 1, around, false, true);
    return mesh;
}

/// Image of a square in the plane z = 0
Mesh patch(const Vec3& centre, double half, const std::function<Vec3(const Vec3&)>& image)
{
    Mesh mesh;
    for (int r = 0; r <= across; ++r)
        for (int c = 0; c <= across; ++c)
            mesh.point.push_back(image(Vec3(centre.x(), centre.y(), 0) +
                                       half * Vec3(2. * r / across - 1, 2. * c / across - 1, 0)));
    add_quads(mesh, 0, across + 1, across + 1, false, false);
    return mesh;
}

Mesh patch(const DrawingExtent& extent, const std::function<Vec3(const Vec3&)>& image)
{
    if (extent.box.isEmpty()) return patch(Vec3::Zero(), 1, image);
    const Vec3 sides = extent.box.sizes();
    const double half = margin * 0.5 * std::max(sides.x(), sides.y());
    return patch(extent.box.center(), half > 0 ? half : 1, image);
}

Mesh fan(double R)
{
    Mesh mesh;
    mesh.point.push_back(Vec3::Zero());
    for (int c = 0; c < around; ++c) {
        mesh.point.push_back(R * Vec3(std::cos(2 * pi * c / around), std::sin(2 * pi * c / around), 0));
        mesh.polygon.push_back({0, 1 + c, 1 + (c + 1) % around});
    }
    return mesh;
}

/// Cylinder of radius R about z; its length is at least its diameter
Mesh tube(double R, const DrawingExtent& extent)
{
    const bool known = !extent.box.isEmpty();
    const double middle = known ? extent.box.center().z() : 0;
    const double half = std::max(R, known ? margin * 0.5 * extent.box.sizes().z() : 0);
    Mesh mesh;
    for (int r = 0; r < around; ++r)
        for (int c = 0; c <= across; ++c)
            mesh.point.emplace_back(R * std::cos(2 * pi * r / around), R * std::sin(2 * pi * r / around),
                                    middle + half * (2. * c / across - 1));
    add_quads(mesh, 0, around, across + 1, true, false);
    return mesh;
}

Mesh ring(double R, double r)
{
    Mesh mesh;
    for (int k = 0; k < around; ++k)
        for (int c = 0; c < down; ++c) {
            const double phi = 2 * pi * k / around, theta = 2 * pi * c / down, rho = R + r * std::cos(theta);
            mesh.point.emplace_back(rho * std::cos(phi), rho * std::sin(phi), r * std::sin(theta));
        }
    add_quads(mesh, 0, around, down, true, true);
    return mesh;
}

/// The triangles of a mesh
Mesh facets(const contact::TriangleMesh& given)
{
    Mesh mesh;
    mesh.point = given.vertices;
    for (const auto& [a, b, c] : given.triangles) mesh.polygon.push_back({a, b, c});
    return mesh;
}

/// Intersection of the ray from the origin along u with the surface, from G < 0 to G >= 0, by bisection;
/// empty if there is none
std::optional<Vec3> exit_point(const Surface& surface, const Vec3& u)
{
    const auto inside = [&](double s) { return surface.value(s * u) < 0; };
    double lower = 0, upper = 0.1 * surface.size();
    if (!inside(lower)) return {};
    while (inside(upper)) {
        if (!(upper < largest_distance * surface.size())) return {};
        lower = upper;
        upper *= 1.2;
    }
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (lower + upper);
        (inside(middle) ? lower : upper) = middle;
    }
    return Vec3(upper * u);
}

/// Removes the points that were not found, and the polygons that contain them
Mesh without_missing_points(const Mesh& all)
{
    Mesh mesh;
    std::vector<int> number(all.point.size(), -1);
    for (size_t k = 0; k < all.point.size(); ++k)
        if (all.point[k].allFinite()) {
            number[k] = static_cast<int>(mesh.point.size());
            mesh.point.push_back(all.point[k]);
        }
    for (std::vector<int> polygon : all.polygon) {
        for (int& k : polygon) k = number[k];
        if (std::find(polygon.begin(), polygon.end(), -1) == polygon.end()) mesh.polygon.push_back(polygon);
    }
    return mesh;
}

Mesh mesh_of(const Surface& surface, const DrawingExtent& extent)
{
    const auto identity = [](const Vec3& a) { return a; };
    if (dynamic_cast<const contact::Plane*>(&surface) != nullptr) return patch(extent, identity);
    if (dynamic_cast<const contact::Foot*>(&surface) != nullptr)
        return patch(Vec3::Zero(), extent.scene_size > 0 ? foot_size * extent.scene_size : 1, identity);
    if (const auto* disk = dynamic_cast<const contact::Disk*>(&surface)) return fan(disk->R);
    if (const auto* cylinder = dynamic_cast<const contact::Cylinder*>(&surface))
        return tube(cylinder->R, extent);
    if (const auto* torus = dynamic_cast<const contact::Torus*>(&surface)) return ring(torus->R, torus->r);
    if (const auto* mesh = dynamic_cast<const contact::MeshSurface*>(&surface)) return facets(mesh->mesh);
    const auto or_missing = [](const auto& find) {
        return [find](const Vec3& at) {
            try {
                return Vec3(find(at).value_or(missing_point()));
            } catch (const lie::NumericalFailure&) {
                return missing_point();
            }
        };
    };
    if (surface.convex()) return sphere_image(or_missing([&](const Vec3& u) { return surface.support(u); }));
    if (!is_unbounded(surface))
        return sphere_image(or_missing([&](const Vec3& u) { return exit_point(surface, u); }));
    return patch(extent, or_missing([&](const Vec3& a) { return std::optional(surface.project(a)); }));
}

}  // namespace

bool is_unbounded(const Surface& surface)
{
    if (surface.convex() || dynamic_cast<const contact::Disk*>(&surface) != nullptr ||
        dynamic_cast<const contact::Torus*>(&surface) != nullptr ||
        dynamic_cast<const contact::MeshSurface*>(&surface) != nullptr)
        return false;
    if (dynamic_cast<const contact::HeightMap*>(&surface) != nullptr) return true;
    for (const double sign : {-1., 1.})
        for (int k = 0; k < 3; ++k)
            if (!exit_point(surface, sign * Vec3::Unit(k))) return true;
    return false;
}

Mesh tessellate(const Surface& surface, const DrawingExtent& extent)
{
    Mesh mesh = without_missing_points(mesh_of(surface, extent));
    if (surface.sigma() < 0)
        for (std::vector<int>& polygon : mesh.polygon) std::reverse(polygon.begin(), polygon.end());
    return mesh;
}

}  // namespace hilda::studies
