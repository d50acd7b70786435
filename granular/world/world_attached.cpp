// SPDX-License-Identifier: GPL-3.0-or-later
// Particles attached to boundaries: a rough wall, drum or base is a boundary with attached particles.
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

using namespace detail;

/// Attaches an inserted particle to its boundary, at their present places.
void World::attach(const Particle& p)
{
    const auto b = static_cast<std::size_t>(p.attached_to);
    rotations.resize(boundaries.size(), {1, {0, 0, 0}});
    attached.push_back(
        {p.id, static_cast<std::uint32_t>(b), rotated_back(rotations[b], p.r - boundaries[b].r)});
    attached_changed = true;
}

/// The number of the boundary to which a particle is attached; -1 if there is none
int World::boundary_of(std::uint32_t id) const
{
    const auto at = std::lower_bound(attached.begin(), attached.end(), id,
                                     [](const AttachedParticle& a, std::uint32_t i) { return a.id < i; });
    return at != attached.end() && at->id == id ? static_cast<int>(at->boundary) : -1;
}

/// Rotates the frames of the boundaries by h ω with the velocities of the move.
void World::rotate_frames()
{
    for (std::size_t b = 0; b < rotations.size(); ++b)
        rotations[b] = turned(rotations[b], options.h * moved[b].omega);
}

/// Passes the list of the attached particles to the engine.
void World::set_attached()
{
    reach.assign(boundaries.size(), 0);
    for (const AttachedParticle& a : attached)  // positive, to mark the boundary
        reach[a.boundary] = std::max({reach[a.boundary], a.X.norm(), 1e-30});
    engine->set_attached(attached);
    attached_changed = false;
}

/// Moves the attached particles to the present places of their boundaries and gives them their velocities.
/// Adds an upper bound of the displacement to particle_displacement. Throws ParticleLost above a cell width.
void World::move_attached()
{
    if (attached.empty()) return;
    poses.resize(boundaries.size());
    if (attached_changed) {
        set_attached();
        posed.clear();
    }
    double largest = 0;
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        const Boundary& b = boundaries[k];
        poses[k] = {b.r, b.v, b.omega, rotations[k]};
        if (posed.empty()) continue;
        const EulerParameters<double>&p = rotations[k], &q = posed[k].p;
        const double cosine = std::min(1.0, std::abs(p.e0 * q.e0 + p.e.dot(q.e))),
                     angle = 2 * std::acos(cosine) + 1e-7;  // acos has an error of 1e-8 near 1
        if (reach[k] > 0) largest = std::max(largest, (b.r - posed[k].r).norm() + angle * reach[k]);
    }
    if (largest >= domain.grid.unit * CellGrid::widest) {
        const std::uint32_t* id = engine->arrays().particle.id.data();
        throw_lost(static_cast<std::uint32_t>(std::find(id, id + inserted_count, attached[0].id) - id),
                   "is attached to a boundary that moves by more than a cell in one step");
    }
    particle_displacement += largest;
    engine->move_attached(domain, poses);
    posed = poses;
}

/// Whether the boundaries have the poses and velocities of the last move_attached()
bool World::is_posed() const
{
    if (attached.empty()) return true;
    if (attached_changed || posed.size() != boundaries.size()) return false;
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        const Boundary& b = boundaries[k];
        const BoundaryPose& last = posed[k];
        const bool is_same = b.r == last.r && b.v == last.v && b.omega == last.omega &&
                             rotations[k].e0 == last.p.e0 && rotations[k].e == last.p.e;
        if (reach[k] > 0 && !is_same) return false;
    }
    return true;
}

}  // namespace hilda::granular
