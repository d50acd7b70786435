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

constexpr int around = 24, down = 12, across = 8;  // divisions of a circle, of half a circle, of a patch
constexpr double margin = 1.1;                     // of a patch beyond what touches it
constexpr double foot_size = 0.05;                 // half a side of a foot, over the motion
constexpr double furthest = 1e3;                   // of a surface from its origin, over its size
constexpr double pi = std::numbers::pi;

Vec3 nowhere() { return Vec3::Constant(std::numeric_limits<double>::quiet_NaN()); }

/// Quads between rows of points; rows and columns may join to rings. The normal is row direction × column direction.
void add_quads(Mesh& mesh, int first, int rows, int columns, bool rows_join, bool columns_join)
{
    const auto at = [&](int r, int c) { return first + r % rows * columns + c % columns; };
    for (int r = 0; r < rows - !rows_join; ++r)
        for (int c = 0; c < columns - !columns_join; ++c)
            mesh.polygon.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)});
}

/// The image of the unit sphere, by latitude and longitude about z
Mesh globe(const std::function<Vec3(const Vec3&)>& image)
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

/// The image of a square in the plane z = 0
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

Mesh patch(const Reach& reach, const std::function<Vec3(const Vec3&)>& image)
{
    if (reach.box.isEmpty()) return patch(Vec3::Zero(), 1, image);
    const Vec3 sides = reach.box.sizes();
    const double half = margin * 0.5 * std::max(sides.x(), sides.y());
    return patch(reach.box.center(), half > 0 ? half : 1, image);
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

/// At least as long as it is wide
Mesh tube(double R, const Reach& reach)
{
    const bool known = !reach.box.isEmpty();
    const double middle = known ? reach.box.center().z() : 0;
    const double half = std::max(R, known ? margin * 0.5 * reach.box.sizes().z() : 0);
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

/// As it was given
Mesh facets(const contact::TriangleMesh& given)
{
    Mesh mesh;
    mesh.point = given.vertices;
    for (const auto& [a, b, c] : given.triangles) mesh.polygon.push_back({a, b, c});
    return mesh;
}

/// Where the ray from the origin along u leaves G < 0
std::optional<Vec3> way_out(const Surface& surface, const Vec3& u)
{
    const auto inside = [&](double s) { return surface.value(s * u) < 0; };
    double lower = 0, upper = 0.1 * surface.size();
    if (!inside(lower)) return {};
    while (inside(upper)) {
        if (!(upper < furthest * surface.size())) return {};
        lower = upper;
        upper *= 1.2;
    }
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (lower + upper);
        (inside(middle) ? lower : upper) = middle;
    }
    return Vec3(upper * u);
}

/// Without the points that were not found, and what was between them
Mesh found(const Mesh& all)
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

Mesh outward(const Surface& surface, const Reach& reach)
{
    const auto as_it_is = [](const Vec3& a) { return a; };
    if (dynamic_cast<const contact::Plane*>(&surface) != nullptr) return patch(reach, as_it_is);
    if (dynamic_cast<const contact::Foot*>(&surface) != nullptr)
        return patch(Vec3::Zero(), reach.motion > 0 ? foot_size * reach.motion : 1, as_it_is);
    if (const auto* disk = dynamic_cast<const contact::Disk*>(&surface)) return fan(disk->R);
    if (const auto* cylinder = dynamic_cast<const contact::Cylinder*>(&surface))
        return tube(cylinder->R, reach);
    if (const auto* torus = dynamic_cast<const contact::Torus*>(&surface)) return ring(torus->R, torus->r);
    if (const auto* mesh = dynamic_cast<const contact::MeshSurface*>(&surface)) return facets(mesh->mesh);
    const auto or_nowhere = [](const auto& find) {
        return [find](const Vec3& at) {
            try {
                return Vec3(find(at).value_or(nowhere()));
            } catch (const lie::NumericalFailure&) {
                return nowhere();
            }
        };
    };
    if (surface.convex()) return globe(or_nowhere([&](const Vec3& u) { return surface.support(u); }));
    if (!endless(surface)) return globe(or_nowhere([&](const Vec3& u) { return way_out(surface, u); }));
    return patch(reach, or_nowhere([&](const Vec3& a) { return std::optional(surface.project(a)); }));
}

}  // namespace

bool endless(const Surface& surface)
{
    if (surface.convex() || dynamic_cast<const contact::Disk*>(&surface) != nullptr ||
        dynamic_cast<const contact::Torus*>(&surface) != nullptr ||
        dynamic_cast<const contact::MeshSurface*>(&surface) != nullptr)
        return false;
    if (dynamic_cast<const contact::HeightMap*>(&surface) != nullptr) return true;
    for (const double sign : {-1., 1.})
        for (int k = 0; k < 3; ++k)
            if (!way_out(surface, sign * Vec3::Unit(k))) return true;
    return false;
}

Mesh tessellated(const Surface& surface, const Reach& reach)
{
    Mesh mesh = found(outward(surface, reach));
    if (surface.sigma() < 0)
        for (std::vector<int>& polygon : mesh.polygon) std::reverse(polygon.begin(), polygon.end());
    return mesh;
}

}  // namespace hilda::studies
