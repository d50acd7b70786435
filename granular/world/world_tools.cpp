// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of the boundaries: prescribed, or that of rigid bodies (tools) under their loads.
#include "granular/core/rigid_body.hpp"
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

using namespace detail;

namespace {

/// Whether the loads move the boundary: a part of a body moves with the body
bool is_tool(const Boundary& b) { return b.mass > 0 && b.body < 0; }

}  // namespace

/// Computes the contact loads on the tools.
void World::find_tool_loads()
{
    if (std::any_of(boundaries.begin(), boundaries.end(), is_tool))
        tool_loads = engine->free_boundary_wrenches(domain), add_part_loads(tool_loads);
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
    place_parts();
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

/// Sets the velocities of the boundaries in the move of the step: v, and the mean ω; of a part from those of
/// its body
void World::set_velocities_of_move(std::vector<BoundaryVelocity>& to) const
{
    to.resize(boundaries.size());
    for (std::size_t k = 0; k < boundaries.size(); ++k)
        if (boundaries[k].body < 0) to[k] = {boundaries[k].v, mean_omega_of(k)};
    for (const BodyPart& part : parts) {
        const auto [v, omega] = to[part.body];
        to[part.number] = {v + omega.cross(boundaries[part.number].r - boundaries[part.body].r), omega};
    }
}

/// Distance from Boundary::r of the points that the rotation of the boundary moves and that count for the
/// neighbour list: those of its surface within the domain, and the centres of particles in contact [m]
double World::rotating_reach(std::size_t k) const
{
    const Boundary& b = boundaries[k];
    const double more = double{domain.largest} + domain.skin;
    switch (b.shape) {
        case Boundary::Shape::mesh: {
            const Meshes::Part* const mesh = meshes->part_of(static_cast<std::uint32_t>(k));
            return mesh != nullptr ? mesh->radius + more : 0;
        }
        case Boundary::Shape::frustum:
        case Boundary::Shape::disk:
        case Boundary::Shape::torus:
            return extent(b) + more;
        case Boundary::Shape::sphere:
        case Boundary::Shape::none:
            return 0;
        case Boundary::Shape::plane:
        case Boundary::Shape::cylinder:
        case Boundary::Shape::cone:
            break;
    }
    // distance from r to the farthest corner of the domain
    const Vec3 a = options.low - b.r, c = options.high - b.r;
    return Vec3{std::max(std::abs(a.x), std::abs(c.x)), std::max(std::abs(a.y), std::abs(c.y)),
                std::max(std::abs(a.z), std::abs(c.z))}
        .norm();
}

void World::set_place(int number, const Vec3& r, const EulerParameters<double>& p)
{
    const auto k = static_cast<std::size_t>(number);
    Boundary& b = boundaries[k];
    const EulerParameters<double> turn = product(p, {b.p.e0, -b.p.e});
    const double displacement =
        (r - b.r).norm() + 2 * std::asin(std::min(turn.e.norm(), 1.)) * rotating_reach(k);
    b.axis = rotated(turn, b.axis);
    b.r = r, b.p = p;
    place_parts();
    boundary_displacement += displacement, path += displacement;
    boundaries_changed = true;
}

/// Moves the boundaries by h v, and rotates meshes, bodies and axes (by Rodrigues' formula) by h ω with the
/// mean ω of the step; then the parts of bodies. Returns an upper bound of the displacement of the boundary
/// points within the domain [m].
double World::move_boundaries()
{
    if (boundaries_rest && !boundaries_changed) return 0;
    boundaries_rest = true;
    const double h = options.h;
    double largest = 0;
    set_velocities_of_move(moved);
    moved_to.resize(boundaries.size());
    rotate_frames();
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        Boundary& b = boundaries[k];
        const Vec3 omega = moved[k].omega;
        boundaries_rest = boundaries_rest && b.v == Vec3{0, 0, 0} && omega == Vec3{0, 0, 0} && b.mass == 0;
        if (b.body >= 0) continue;
        b.r += h * b.v;
        double displacement = h * b.v.norm();
        const double angle = h * omega.norm();
        const bool has_axis = b.shape != Boundary::Shape::mesh && b.shape != Boundary::Shape::sphere &&
                              b.shape != Boundary::Shape::none;
        if (b.shape == Boundary::Shape::mesh || b.mass > 0 || has_parts(k)) rotate(b, omega, h);
        if (!has_axis) {
            displacement += angle * rotating_reach(k);
        } else if (omega.cross(b.axis).norm() > 0) {
            const Vec3 e = (h / angle) * omega;
            const Vec3 direction = std::cos(angle) * b.axis + std::sin(angle) * e.cross(b.axis) +
                                   ((1 - std::cos(angle)) * e.dot(b.axis)) * e;
            b.axis = (1 / direction.norm()) * direction;
            displacement += angle * rotating_reach(k);
        }
        largest = std::max(largest, displacement);
    }
    for (const BodyPart& part : parts) {
        place(part);
        const Boundary& body = boundaries[part.body];
        const double angle = h * moved[part.number].omega.norm();
        largest =
            std::max(largest, h * body.v.norm() + angle * (part.X.norm() + rotating_reach(part.number)));
    }
    for (std::size_t k = 0; k < boundaries.size(); ++k) moved_to[k] = BoundaryPlace(boundaries[k]);
    return largest;
}

}  // namespace hilda::granular
