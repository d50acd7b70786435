// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/tessellation.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace hilda::contact {

namespace {

constexpr double largest_distance =
    1e3;  // of a surface point from the origin, relative to the size of the surface
constexpr double pi = std::numbers::pi;

Vec3 missing_point() { return Vec3::Constant(std::numeric_limits<double>::quiet_NaN()); }

void add_quads(PolygonMesh& mesh, int first, int rows, int columns, bool rows_join, bool columns_join)
{
    const auto at = [&](int r, int c) { return first + r % rows * columns + c % columns; };
    for (int r = 0; r < rows - !rows_join; ++r)
        for (int c = 0; c < columns - !columns_join; ++c)
            mesh.polygon.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)});
}

/// Image of the unit sphere, with a grid of latitude and longitude about z
PolygonMesh sphere_image(const std::function<Vec3(const Vec3&)>& image)
{
    PolygonMesh mesh;
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

/// The point of the surface above or below (a.x, a.y), at the height nearest to the extent; empty if the
/// surface has none within three times the extent
std::optional<Vec3> point_above(const Surface& surface, const Vec3& a, const DrawingExtent& extent)
{
    constexpr int samples = 200;
    const bool is_empty = extent.box.isEmpty();
    const double low = is_empty ? -1 : extent.box.min().z(), high = is_empty ? 1 : extent.box.max().z();
    const double side = is_empty ? 0 : extent.box.sizes().maxCoeff(), middle = 0.5 * (low + high);
    const double reach = 1.5 * std::max(high - low, side);
    if (!(reach > 0)) return {};
    const auto G = [&](double z) { return surface.value({a.x(), a.y(), z}); };
    std::optional<double> nearest;
    for (int k = 0; k < samples; ++k) {
        double z_0 = middle + reach * (2. * k / samples - 1),
               z_1 = middle + reach * (2. * (k + 1) / samples - 1);
        const bool is_inside = G(z_0) < 0;
        if (is_inside == (G(z_1) < 0)) continue;
        for (int bisection = 0; bisection < 60; ++bisection) {
            const double z = 0.5 * (z_0 + z_1);
            ((G(z) < 0) == is_inside ? z_0 : z_1) = z;
        }
        if (!nearest || std::abs(z_1 - middle) < std::abs(*nearest - middle)) nearest = z_1;
    }
    if (!nearest) return {};
    return Vec3(a.x(), a.y(), *nearest);
}

}  // namespace

bool Surface::is_unbounded() const
{
    if (convex()) return false;
    for (const double sign : {-1., 1.})
        for (int k = 0; k < 3; ++k)
            if (!exit_point(*this, sign * Vec3::Unit(k))) return true;
    return false;
}

PolygonMesh Surface::drawing(const DrawingExtent& extent) const
{
    const auto or_missing = [](const auto& find) {
        return [find](const Vec3& at) {
            try {
                return Vec3(find(at).value_or(missing_point()));
            } catch (const lie::NumericalFailure&) {
                return missing_point();
            }
        };
    };
    if (convex()) return sphere_image(or_missing([&](const Vec3& u) { return support(u); }));
    if (!is_unbounded()) return sphere_image(or_missing([&](const Vec3& u) { return exit_point(*this, u); }));
    return square(extent, or_missing([&](const Vec3& a) {
                      const std::optional<Vec3> above = point_above(*this, a, extent);
                      return above ? above : std::optional(project(a));
                  }));
}

PolygonMesh grid(int rows, int columns, bool rows_join, bool columns_join,
                 const std::function<Vec3(int row, int column)>& point)
{
    PolygonMesh mesh;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) mesh.point.push_back(point(r, c));
    add_quads(mesh, 0, rows, columns, rows_join, columns_join);
    return mesh;
}

PolygonMesh square(const Vec3& centre, double half, const std::function<Vec3(const Vec3&)>& image)
{
    return grid(across + 1, across + 1, false, false, [&](int r, int c) {
        return image(Vec3(centre.x(), centre.y(), 0) +
                     half * Vec3(2. * r / across - 1, 2. * c / across - 1, 0));
    });
}

PolygonMesh square(const DrawingExtent& extent, const std::function<Vec3(const Vec3&)>& image)
{
    if (extent.box.isEmpty()) return square(Vec3::Zero(), 1, image);
    const Vec3 sides = extent.box.sizes();
    const double half = DrawingExtent::margin * 0.5 * std::max(sides.x(), sides.y());
    return square(extent.box.center(), half > 0 ? half : 1, image);
}

PolygonMesh tessellate(const Surface& surface, const DrawingExtent& extent)
{
    const PolygonMesh all = surface.drawing(extent);
    PolygonMesh mesh;
    std::vector<int> number(all.point.size(), -1);
    for (size_t k = 0; k < all.point.size(); ++k)
        if (all.point[k].allFinite()) {
            number[k] = static_cast<int>(mesh.point.size());
            mesh.point.push_back(all.point[k]);
        }
    for (std::vector<int> polygon : all.polygon) {
        for (int& k : polygon) k = number[k];
        if (std::find(polygon.begin(), polygon.end(), -1) != polygon.end()) continue;
        if (surface.sigma() < 0) std::reverse(polygon.begin(), polygon.end());
        mesh.polygon.push_back(polygon);
    }
    return mesh;
}

}  // namespace hilda::contact
