// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/surface_notices.hpp"

#include "io/message.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

constexpr double infinite = BoundingBox::infinite;
constexpr double parallel = 1e-9;  // largest component of a unit vector that is zero up to rounding

double along(const Vec3& a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/// Half the extent along an axis of a circle with this unit normal [m]
double half_extent(double radius, const Vec3& normal, int axis)
{
    const double n = along(normal, axis);
    return radius * std::sqrt(std::max(0., 1 - n * n));
}

struct Extent {
    double low, high;  // [m]
};

Extent extent(const Boundary& b, int axis)
{
    const double r = along(b.r, axis), a = along(b.axis, axis);
    const auto about = [&](double centre, double half) { return Extent{centre - half, centre + half}; };
    switch (b.shape) {
        case Boundary::Shape::sphere:
            return about(r, b.radius);
        case Boundary::Shape::torus:
            return about(r, half_extent(b.second_radius, b.axis, axis) + b.radius);
        case Boundary::Shape::disk:
            return about(r, half_extent(b.radius, b.axis, axis));
        case Boundary::Shape::frustum: {
            const Extent x = about(r + b.from * a, half_extent(b.radius, b.axis, axis)),
                         y = about(r + b.to * a, half_extent(b.second_radius, b.axis, axis));
            return {std::min(x.low, y.low), std::max(x.high, y.high)};
        }
        case Boundary::Shape::cylinder:
            if (std::abs(a) < parallel) return about(r, b.radius);
            break;
        case Boundary::Shape::plane:
            if (1 - std::abs(a) < parallel) return about(r, 0);
            break;
        default:
            break;
    }
    return {-infinite, infinite};
}

UniformRange uniform_range(const Boundary& b, int axis)
{
    const double a = along(b.axis, axis);
    const bool is_parallel = 1 - std::abs(a) < parallel;
    if (b.shape == Boundary::Shape::none || (b.shape == Boundary::Shape::plane && std::abs(a) < parallel) ||
        (b.shape == Boundary::Shape::cylinder && is_parallel))
        return {-infinite, infinite};
    if (b.shape == Boundary::Shape::frustum && is_parallel && b.radius == b.second_radius) {
        const auto [low, high] = extent(b, axis);
        return {low, high};
    }
    return {infinite, -infinite};
}

}  // namespace

BoundingBox bounds(const NamedBoundary& b)
{
    BoundingBox box;
    if (b.mesh) {
        for (const Vec3& v : b.mesh->vertex) box.add(b.boundary.r + rotated(b.boundary.p, v));
        return box;
    }
    const Extent x = extent(b.boundary, 0), y = extent(b.boundary, 1), z = extent(b.boundary, 2);
    return {{x.low, y.low, z.low}, {x.high, y.high, z.high}};
}

UniformRange uniform_range(const NamedBoundary& b, int axis)
{
    if (!b.mesh) return uniform_range(b.boundary, axis);
    const BoundingBox box = bounds(b);
    UniformRange range{along(box.low, axis), along(box.high, axis)};
    const double middle = 0.5 * (range.from + range.until);
    for (const auto& triangle : b.mesh->triangle) {
        Vec3 corner[3];
        BoundingBox own;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = b.boundary.r + rotated(b.boundary.p, b.mesh->vertex[triangle[k]]);
            own.add(corner[k]);
        }
        const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        if (std::abs(along(normal, axis)) <= parallel * normal.norm()) continue;
        // a face at an end, or between the end and the part that does not change
        if (along(own.high, axis) <= middle)
            range.from = std::max(range.from, along(own.high, axis));
        else if (along(own.low, axis) >= middle)
            range.until = std::min(range.until, along(own.low, axis));
        else
            return {infinite, -infinite};
    }
    return range;
}

void SurfaceNotices::add(const std::string& place, const NamedBoundary& b, const World& world, Notices& to)
{
    Surface s{.place = place,
              .is_mesh = b.mesh.has_value(),
              .faces_inwards = false,
              .box = bounds(b),
              .uniform = {}};
    for (int axis = 0; axis < 3; ++axis) s.uniform[static_cast<std::size_t>(axis)] = uniform_range(b, axis);
    if (s.is_mesh) {
        // The volume has no meaning for an open mesh.
        s.faces_inwards = !b.two_sided && mass_properties(*b.mesh).volume < 0 && open_edges(*b.mesh) == 0;
        for (int axis = 0; axis < 3; ++axis)
            if (along(s.box.high, axis) < along(world.low(), axis) ||
                along(s.box.low, axis) > along(world.high(), axis))
                to.push_back(place + ": the mesh is outside of the domain along " + "xyz"[axis]);
    }
    if (b.boundary.shape != Boundary::Shape::none) all.push_back(std::move(s));
}

void SurfaceNotices::check_periodic_sides(const World& world, double diameter, Notices& to) const
{
    const double R = 0.5 * diameter;
    for (const Surface& s : all)
        for (int axis = 0; axis < 3; ++axis) {
            const double low = along(world.low(), axis), high = along(world.high(), axis);
            const UniformRange uniform = s.uniform[static_cast<std::size_t>(axis)];
            if (!world.periodic()[static_cast<std::size_t>(axis)] ||
                (uniform.from <= low - R && uniform.until >= high + R))
                continue;
            const double from = along(s.box.low, axis), until = along(s.box.high, axis);
            if ((from > low + R && until < high - R) || from > high + R || until < low - R) continue;
            to.push_back(
                s.place + ": the " + (s.is_mesh ? "mesh" : "boundary") + " reaches a periodic side along " +
                "xyz"[axis] +
                ", across which it has no images: particles that are near its image do not touch it. It "
                "acts as a periodic one only if its shape does not change along this axis and it "
                "extends beyond both sides by the radius of a particle");
        }
}

void SurfaceNotices::check_sizes(const World& world, double diameter, Notices& to) const
{
    const double domain = (world.high() - world.low()).norm();
    for (const Surface& m : all) {
        if (!m.is_mesh) continue;
        const double size = (m.box.high - m.box.low).norm();
        if (size > 100 * domain || size < 0.1 * diameter)
            to.push_back(m.place +
                         io::formatted(": the mesh is %.3g m long, the %s %.3g m: its coordinates must be in "
                                       "m, or have the key scale",
                                       size, size > domain ? "domain" : "diameter of a particle",
                                       size > domain ? domain : diameter));
    }
}

void SurfaceNotices::check_sides(const World& world, Notices& to) const
{
    for (const Surface& m : all) {
        if (!m.faces_inwards) continue;
        std::size_t count = 0, outside = 0;
        world.each_particle([&](const Particle& p) {
            const Vec3 a = p.r - m.box.low, b = m.box.high - p.r;
            ++count, outside += std::min({a.x, a.y, a.z, b.x, b.y, b.z}) < 0 ? 1 : 0;
        });
        if (outside > 0)
            to.push_back(m.place + ": the mesh is closed and its normals point inwards, but " +
                         std::to_string(outside) + " of " + std::to_string(count) +
                         " particles are outside of it, where they do not touch it: for particles outside a "
                         "box needs inside false, and other meshes the reverse order of vertices");
    }
}

}  // namespace hilda::granular
