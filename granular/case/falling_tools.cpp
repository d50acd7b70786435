// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/falling_tools.hpp"

#include "io/message.hpp"

namespace hilda::granular {

namespace {

constexpr double everywhere = std::numeric_limits<double>::infinity();

/// Largest distance of a point of boundary k from a point [m]
double reach(const World& world, std::size_t k, const Vec3& from)
{
    const Boundary& b = world.all_boundaries()[k];
    if (b.shape == Boundary::Shape::none) return 0;
    if (b.shape == Boundary::Shape::plane || b.shape == Boundary::Shape::cylinder ||
        b.shape == Boundary::Shape::cone)
        return everywhere;
    double own = extent(b);
    if (const Meshes::Part* mesh = world.all_meshes().part_of(static_cast<std::uint32_t>(k)))
        own = mesh->radius;
    return (b.r - from).norm() + own;
}

/// A body, the direction in which it is pulled and the radius of the ball that contains its surfaces [m]
struct Way {
    std::size_t body;
    Vec3 direction;
    double radius;
};

/// Whether a particle is in front of the body, or touches it, on its way of this length
bool is_held(const World& world, const Way& way, double length)
{
    bool held = false;
    const Vec3 r = world.all_boundaries()[way.body].r;
    world.each_particle([&](const Particle& p) {
        const Vec3 d = p.r - r;
        const double along = d.dot(way.direction), across = (d - along * way.direction).norm();
        held = held || (along > -way.radius && along < length && across < way.radius + p.radius);
    });
    return held;
}

}  // namespace

std::vector<FallingTool> falling_tools(const World& world, const std::vector<std::string>& names,
                                       const Vec3& gravity)
{
    std::vector<FallingTool> all;
    const std::vector<Boundary>& boundaries = world.all_boundaries();
    const auto body_of = [&](std::size_t k) {
        return boundaries[k].body < 0 ? k : static_cast<std::size_t>(boundaries[k].body);
    };
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        const Boundary& b = boundaries[k];
        if (!(b.mass > 0) || b.body >= 0) continue;
        const Vec3 F = b.mass * gravity + b.F,
                   pull = {b.free[0] ? F.x : 0, b.free[1] ? F.y : 0, b.free[2] ? F.z : 0};
        if (!(pull.norm() > 0)) continue;
        Way way{k, (1 / pull.norm()) * pull, 0};
        for (std::size_t part = 0; part < boundaries.size(); ++part)
            if (body_of(part) == k) way.radius = std::max(way.radius, reach(world, part, b.r));
        for (std::size_t p = 0; p < boundaries.size(); ++p) {
            const Boundary& plane = boundaries[p];
            if (plane.shape != Boundary::Shape::plane || body_of(p) == k) continue;
            const double height = plane.axis.dot(b.r - plane.r), speed = -plane.axis.dot(way.direction);
            if (!(height > 0) || !(speed > 1e-6) || is_held(world, way, height / speed)) continue;
            all.push_back(
                {static_cast<int>(k),
                 io::formatted("nothing holds boundary '%s' above '%s', towards which it is pulled: "
                               "boundaries do not touch each other, and only particles can hold it",
                               names[k].c_str(), names[p].c_str())});
            break;
        }
    }
    return all;
}

}  // namespace hilda::granular
