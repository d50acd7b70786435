// SPDX-License-Identifier: GPL-3.0-or-later
// Removal of the particles that have left the domain. It takes place in a neighbour search within a step, so
// that it depends neither on the outputs nor on the number of threads.
#include "granular/world/world_impl.hpp"

#include <algorithm>

namespace hilda::granular {

using namespace detail;

/// Places of the particles with these ids in the arrays; that of a pending particle is not defined. Throws
/// io::InvalidInput for an id that no particle has.
std::vector<std::uint32_t> World::places_of(const std::vector<std::uint32_t>& ids, const char* where) const
{
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> place_of(next_id, none), places;
    const std::uint32_t* const id = engine->arrays().particle.id.data();
    for (std::uint32_t k = 0; k < inserted_count; ++k) place_of[id[k]] = k;
    places.reserve(ids.size());
    for (const std::uint32_t i : ids) {
        places.push_back(i < next_id ? place_of[i] : none);
        if (i >= next_id + pending.size() || (i < next_id && places.back() == none))
            refuse(where, "no particle has this id", i);
    }
    return places;
}

/// Throws ParticleLost for a particle that has left the domain.
void World::throw_left(std::uint32_t id) const
{
    particle_lost = true;
    // The search has changed owner cells: a restored world has to search again, and finds the particle.
    particle_displacement = std::numeric_limits<double>::infinity();
    const std::uint32_t* ids = engine->arrays().particle.id.data();
    throw_lost(static_cast<std::uint32_t>(std::find(ids, ids + inserted_count, id) - ids),
               "has left the domain");
}

/// Records that a particle leaves the arrays.
void World::record_removal(const LeavingParticle& p, std::uint32_t side)
{
    const std::uint32_t clump = clump_of(p.id);
    const double share = clump == no_clump ? 1 : fraction_of(p.id, clump);
    removed_particles.push_back({.t = time,
                                 .r = global_position(domain.grid, p.position),
                                 .v = to_double(p.velocity),
                                 .omega = to_double(p.omega),
                                 .radius = p.velocity.w,
                                 .mass = p.omega.w > 0 ? share / static_cast<double>(p.omega.w) : 0,
                                 .id = p.id,
                                 .side = side});
}

/// Removes and records the particles outside the domain. Throws ParticleLost for a particle outside that has
/// left through another side. The particles of a clump leave with its centre of mass.
void World::remove_outside()
{
    const std::size_t first = removed_particles.size();
    const auto leave = [&](const LeavingParticle& p, int side) {
        if (!options.outflow[static_cast<std::size_t>(side)] && !options.delete_lost) throw_left(p.id);
        record_removal(p, static_cast<std::uint32_t>(side));
    };
    if (templates.empty()) {
        for (const LeavingParticle& p : engine->outside(domain))
            leave(p, side_behind(domain.grid, p.position));
    } else {
        const Particles<par::Cpu>& p = engine->arrays().particle;
        const par::Array<par::Cpu, ClumpBody>& clump = engine->arrays().clump;
        std::vector<int> side_of_clump;
        for (std::size_t k = 0; k < clump.size(); ++k)
            side_of_clump.push_back(side_behind(domain.grid, clump.data()[k].position));
        for (std::uint32_t k = 0; k < p.count; ++k) {
            const std::uint32_t c = clump_of(p.id.data()[k]);
            const int side =
                c == no_clump ? side_behind(domain.grid, p.position.data()[k]) : side_of_clump[c];
            if (side >= 0) leave(leaving_particle(p, k), side);
        }
    }
    remove_recorded(first);
}

void World::remove(const std::vector<std::uint32_t>& ids)
{
    insert_pending();
    const Particles<par::Cpu>& p = engine->arrays().particle;
    const par::Array<par::Cpu, ClumpBody>& clump = engine->arrays().clump;
    const std::size_t first = removed_particles.size();
    std::vector<bool> is_listed_clump(clump.size(), false);
    for (const std::uint32_t id : ids)
        if (const std::uint32_t c = clump_of(id); c != no_clump) is_listed_clump[c] = true;
    const auto is_listed = [&](std::uint32_t id) {
        const std::uint32_t c = clump_of(id);
        return c == no_clump ? std::binary_search(ids.begin(), ids.end(), id) : is_listed_clump[c];
    };
    for (std::uint32_t k = 0; k < p.count; ++k)
        if (is_listed(p.id.data()[k])) record_removal(leaving_particle(p, k), RemovedParticle::none);
    if (removed_particles.size() == first) return;
    const auto is_removed_one = [&](const AttachedParticle& a) {
        return std::binary_search(ids.begin(), ids.end(), a.id);
    };
    if (std::erase_if(attached, is_removed_one) > 0) attached_changed = true;
    if (attached.empty()) posed.clear();
    remove_recorded(first);
    invalidate_neighbours();
}

/// Removes the particles that are in removed_particles from `first` on. A neighbour search has to follow.
void World::remove_recorded(std::size_t first)
{
    if (removed_particles.size() == first) return;
    std::sort(removed_particles.begin() + static_cast<std::ptrdiff_t>(first), removed_particles.end(),
              [](const RemovedParticle& x, const RemovedParticle& y) { return x.id < y.id; });
    std::vector<std::uint32_t> ids;
    for (std::size_t k = first; k < removed_particles.size(); ++k) {
        ++total_outflow.count, total_outflow.mass += removed_particles[k].mass;
        ids.push_back(removed_particles[k].id);
    }
    engine->remove(ids);
    inserted_count -= ids.size();
    if (!templates.empty()) {
        par::Array<par::Cpu, ClumpBody>& clump = engine->arrays().clump;
        std::vector<std::uint32_t> kept;
        for (std::uint32_t c = 0; c < clump.size(); ++c)
            if (!std::binary_search(ids.begin(), ids.end(), clump.data()[c].first_id)) kept.push_back(c);
        keep(clump, kept);
        update_clump_tables();
        engine->arrays_modified();
    }
    start_balance();
}

}  // namespace hilda::granular
