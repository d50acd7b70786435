// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of the boundaries: prescribed, or that of rigid bodies (tools) under their loads.
#include "granular/core/rigid_body.hpp"
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

using namespace detail;

namespace {

bool is_tool(const Boundary& b) { return b.mass > 0; }

}  // namespace

/// Computes the contact loads on the tools.
void World::find_tool_loads()
{
    if (std::any_of(boundaries.begin(), boundaries.end(), is_tool))
        tool_loads = engine->free_boundary_wrenches(domain);
    else
        tool_loads.clear();
}

/// Adds the impulses of the loads on the tools over `part` of a step to their momenta.
///
/// Velocity Verlet: half a step before and after the move; all other schemes: a step before the move
/// (symplectic Euler).
void World::accelerate_tools(double part)
{
    if (tool_loads.empty()) return;
    tool_loads.resize(boundaries.size());  // a boundary may have been added since then
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        Boundary& b = boundaries[k];
        if (!is_tool(b)) continue;
        accelerate(b, tool_loads[k].F + b.F, tool_loads[k].T + b.T, options.gravity, part * options.h);
    }
}

/// mean_omega() with the number of the boundary and the time in the message
Vec3 World::mean_omega_of(std::size_t k) const
{
    try {
        return mean_omega(boundaries[k], options.h);
    } catch (const io::NumericalFailure& e) {
        std::ostringstream text;
        text.precision(9);
        text << "boundary " << k << ' ' << e.what() << ", at t = " << t() << " s";
        throw io::NumericalFailure(e.status, text.str());
    }
}

/// Moves the boundaries by h v, and rotates meshes, tools and axes (by Rodrigues' formula) by h ω with the
/// mean ω of the step. Returns an upper bound of the displacement of the boundary points within the domain
/// [m].
double World::move_boundaries()
{
    if (boundaries_rest && !boundaries_changed) return 0;
    boundaries_rest = true;
    const double h = options.h;
    double largest = 0;
    moved.resize(boundaries.size()), moved_to.resize(boundaries.size());
    for (std::size_t k = 0; k < boundaries.size(); ++k) moved[k] = {boundaries[k].v, mean_omega_of(k)};
    auto part = meshes->part.begin();
    rotate_frames();
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        Boundary& b = boundaries[k];
        const Vec3 omega = moved[k].omega;
        boundaries_rest = boundaries_rest && b.v == Vec3{0, 0, 0} && omega == Vec3{0, 0, 0} && b.mass == 0;
        b.r += h * b.v;
        double displacement = h * b.v.norm();
        const double angle = h * omega.norm();
        if (b.shape == Boundary::Shape::mesh || b.mass > 0) rotate(b, omega, h);
        if (b.shape == Boundary::Shape::mesh) {
            if (part != meshes->part.end() && part->boundary == k) {
                // also of the centres of particles in contact
                displacement += angle * (part->radius + double{domain.largest} + domain.skin);
                ++part;
            }
        } else if (b.shape != Boundary::Shape::sphere && omega.cross(b.axis).norm() > 0) {
            const Vec3 e = (h / angle) * omega;
            const Vec3 direction = std::cos(angle) * b.axis + std::sin(angle) * e.cross(b.axis) +
                                   ((1 - std::cos(angle)) * e.dot(b.axis)) * e;
            b.axis = (1 / direction.norm()) * direction;
            // distance from r to the farthest corner of the domain
            const Vec3 a = options.low - b.r, c = options.high - b.r;
            displacement +=
                angle * Vec3{std::max(std::abs(a.x), std::abs(c.x)), std::max(std::abs(a.y), std::abs(c.y)),
                             std::max(std::abs(a.z), std::abs(c.z))}
                            .norm();
        }
        largest = std::max(largest, displacement);
        moved_to[k] = BoundaryPlace(b);
    }
    return largest;
}

}  // namespace hilda::granular
