// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/insertion/obstacles.hpp"

#include "granular/core/surfaces/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// Whether a point is within a box that is wider by `more` on all sides
bool is_within(const Vec3& r, const Vec3& low, const Vec3& high, double more)
{
    return r.x > low.x - more && r.x < high.x + more && r.y > low.y - more && r.y < high.y + more &&
           r.z > low.z - more && r.z < high.z + more;
}

/// Calls f for r and its images across the periodic sides of the domain.
template <class F>
void for_images(const World& world, const Vec3& r, const F& f)
{
    const Vec3 size = world.high() - world.low();
    const std::array<bool, 3>& periodic = world.periodic();
    const auto last = [&](unsigned axis) { return periodic[axis] ? 1 : 0; };
    for (int x = -last(0); x <= last(0); ++x)
        for (int y = -last(1); y <= last(1); ++y)
            for (int z = -last(2); z <= last(2); ++z) f(r + Vec3{x * size.x, y * size.y, z * size.z});
}

}  // namespace

Obstacles::Obstacles(const World& world, const Vec3& low, const Vec3& high, double R, std::uint16_t replica)
    : world(world), surfaces{world.all_boundaries().data(), world.all_meshes().view()}, closed(world),
      low(low), high(high), reach(R)
{
    std::vector<Sphere> all;
    double largest = R;
    world.each_particle([&](const Particle& p) {
        if (p.replica != replica) return;
        for_images(world, p.r, [&](const Vec3& r) {
            if (!is_within(r, low, high, R + p.radius)) return;
            all.push_back({r, p.radius});
            largest = std::max(largest, p.radius);
        });
    });
    edge = 2 * largest;
    for (const Sphere& s : all) cells[cell_of(s.r)].push_back(s);

    for (std::uint32_t k = 0; k < world.all_boundaries().size(); ++k)
        if (world.all_boundaries()[k].shape != Boundary::Shape::mesh) near.push_back(k);
    const Meshes& meshes = world.all_meshes();
    for (std::uint32_t t = 0; t < meshes.triangle.size(); ++t) {
        const Boundary& b = world.all_boundaries()[meshes.triangle[t].boundary];
        BoundingBox box;
        for (const std::uint32_t v : meshes.triangle[t].vertex) box.add(b.r + rotated(b.p, meshes.vertex[v]));
        if (box.low.x < high.x + R && box.high.x > low.x - R && box.low.y < high.y + R &&
            box.high.y > low.y - R && box.low.z < high.z + R && box.high.z > low.z - R)
            near.push_back(Surfaces::first_triangle + t);
    }
}

Obstacles::Cell Obstacles::cell_of(const Vec3& r) const
{
    const auto index = [&](double x) { return static_cast<std::int64_t>(std::floor(x / edge)); };
    return {index(r.x), index(r.y), index(r.z)};
}

bool Obstacles::touches(const Vec3& r, double radius, double allowed) const
{
    for (const std::uint32_t k : near) {
        const Boundary& b = world.all_boundaries()[surfaces.boundary_of(k)];
        const bool is_full = b.shape != Boundary::Shape::frustum && is_larger_than(b, radius);
        if (is_full || surfaces.nearest(k, r, radius).distance < (1 - allowed) * radius) return true;
    }
    const Cell at = cell_of(r);
    for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x)
        for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
            for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
                const auto cell = cells.find({x, y, z});
                if (cell == cells.end()) continue;
                for (const Sphere& s : cell->second)
                    if ((s.r - r).norm() < s.radius + radius - allowed * std::min(s.radius, radius))
                        return true;
            }
    return !closed.allow(r);
}

void Obstacles::add(const Vec3& r, double radius)
{
    for_images(world, r, [&](const Vec3& image) {
        if (is_within(image, low, high, reach + radius)) cells[cell_of(image)].push_back({image, radius});
    });
}

}  // namespace hilda::granular
