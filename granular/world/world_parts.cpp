// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of rigid bodies: boundaries that move with another boundary and load it.
#include "granular/world/world_impl.hpp"

namespace hilda::granular {

using namespace detail;

void World::set_part(int part, int body)
{
    const int n = static_cast<int>(boundaries.size());
    for (const int number : {part, body})
        if (number < 0 || number >= n) refuse("part", "no boundary has this number", number);
    Boundary& b = boundaries[static_cast<std::size_t>(part)];
    const Boundary& to = boundaries[static_cast<std::size_t>(body)];
    const std::string where = "boundary " + std::to_string(part);
    if (step_count > 0) refuse(where, "must become a part before the first step", step_count);
    if (part == body) refuse(where, "must not be a part of itself", body);
    if (b.body >= 0) refuse(where, "is a part already, of the boundary", b.body);
    if (to.body >= 0)
        refuse(where, "must be a part of a boundary that is not a part itself, of the boundary", body);
    if (has_parts(static_cast<std::size_t>(part)))
        refuse(where, "has parts itself and must not be one of", body);
    if (b.mass > 0) refuse(where, "must have no mass, because it is a part of a boundary", b.mass);
    const EulerParameters<double> back = {to.p.e0, -to.p.e};
    parts.push_back({static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(body),
                     rotated_back(to.p, b.r - to.r), rotated_back(to.p, b.axis), product(back, b.p)});
    b.body = body, b.mass = to.mass;
    is_body.resize(boundaries.size()), is_body[parts.back().body] = true;
    place(parts.back());
    start_balance();
    invalidate_neighbours();
}

/// Sets place and velocity of a part from those of its body:
///
///     r = r_b + A_b X,    v = v_b + ω_b × A_b X,    ω = ω_b
void World::place(const BodyPart& part)
{
    Boundary& b = boundaries[part.number];
    const Boundary& body = boundaries[part.body];
    const Vec3 d = rotated(body.p, part.X);
    b.r = body.r + d, b.axis = rotated(body.p, part.axis), b.p = product(body.p, part.p);
    b.v = body.v + body.omega.cross(d), b.omega = body.omega;
}

void World::place_parts()
{
    for (const BodyPart& part : parts) place(part);
}

/// Adds the loads on the parts to those on their bodies, about Boundary::r of the body.
void World::add_part_loads(std::vector<Wrench>& loads) const
{
    for (const BodyPart& part : parts) {
        const Wrench& of_part = loads[part.number];
        Wrench& of_body = loads[part.body];
        of_body.F += of_part.F;
        of_body.T += of_part.T + (boundaries[part.number].r - boundaries[part.body].r).cross(of_part.F);
    }
}

}  // namespace hilda::granular
