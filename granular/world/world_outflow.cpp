// SPDX-License-Identifier: GPL-3.0-or-later
// Removal of the particles that have left the domain. It takes place in a neighbour search within a step, so
// that it depends neither on the outputs nor on the number of threads.
#include "granular/world/world_impl.hpp"

#include <algorithm>

namespace hilda::granular {

using namespace detail;

namespace {

/// The side of the domain behind which the particle is, that with the largest distance; -1 if it is inside.
/// The condition is that of the neighbour search.
int side_behind(const CellGrid& g, const Position& p)
{
    int side = -1;
    std::int64_t farthest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (g.periodic[axis] != 0) continue;
        const std::int64_t x = coordinate(g, p, axis),
                           high = std::int64_t{g.width[axis]} * (g.cells[axis] - 1) + g.last[axis];
        if (-x > farthest) farthest = -x, side = 2 * axis;
        if (x - high > farthest) farthest = x - high, side = 2 * axis + 1;
    }
    return side;
}

/// Keeps the first `kept` elements of those that `index` lists.
template <class Array>
void keep(Array& values, const std::vector<std::uint32_t>& index)
{
    if (values.size() == 0) return;
    for (std::size_t k = 0; k < index.size(); ++k) values.data()[k] = values.data()[index[k]];
    values.resize(index.size());
}

}  // namespace

bool World::is_removed(std::uint32_t id) const
{
    if (id >= next_id) return id >= next_id + pending.size();
    if (next_id == inserted_count) return false;
    const std::uint32_t* ids = engine->arrays().particle.id.data();
    return std::find(ids, ids + inserted_count, id) == ids + inserted_count;
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

/// The record of the particle with index k in the arrays
RemovedParticle World::removed_at(std::uint32_t k, std::uint32_t side) const
{
    const Particles<par::Cpu>& p = engine->arrays().particle;
    const Float4 v = p.velocity.data()[k], w = p.omega.data()[k];
    const std::uint32_t id = p.id.data()[k], clump = clump_of(id);
    const double share = clump == no_clump ? 1 : fraction_of(id, clump);
    return {.t = time,
            .r = global_position(domain.grid, p.position.data()[k]),
            .v = to_double(v),
            .omega = to_double(w),
            .radius = v.w,
            .mass = w.w > 0 ? share / static_cast<double>(w.w) : 0,
            .id = id,
            .side = side};
}

/// Removes and records the particles outside the domain. Throws ParticleLost for a particle outside that has
/// left through another side. The particles of a clump leave with its centre of mass.
void World::remove_outside()
{
    const Particles<par::Cpu>& p = engine->arrays().particle;
    const par::Array<par::Cpu, ClumpBody>& clump = engine->arrays().clump;
    std::vector<std::uint32_t> kept;
    const std::size_t first = removed_particles.size();
    std::vector<int> side_of_clump;
    for (std::size_t k = 0; k < clump.size(); ++k)
        side_of_clump.push_back(side_behind(domain.grid, clump.data()[k].position));
    for (std::uint32_t k = 0; k < p.count; ++k) {
        const std::uint32_t c = clump_of(p.id.data()[k]);
        const int side = c == no_clump ? side_behind(domain.grid, p.position.data()[k]) : side_of_clump[c];
        if (side < 0) {
            kept.push_back(k);
            continue;
        }
        if (!options.outflow[static_cast<std::size_t>(side)] && !options.delete_lost)
            throw_left(p.id.data()[k]);
        removed_particles.push_back(removed_at(k, static_cast<std::uint32_t>(side)));
    }
    keep_particles(kept, first);
}

void World::remove(const std::vector<std::uint32_t>& ids)
{
    insert_pending();
    const Particles<par::Cpu>& p = engine->arrays().particle;
    const par::Array<par::Cpu, ClumpBody>& clump = engine->arrays().clump;
    std::vector<std::uint32_t> kept;
    const std::size_t first = removed_particles.size();
    std::vector<bool> is_listed_clump(clump.size(), false);
    for (const std::uint32_t id : ids)
        if (const std::uint32_t c = clump_of(id); c != no_clump) is_listed_clump[c] = true;
    const auto is_listed = [&](std::uint32_t id) {
        const std::uint32_t c = clump_of(id);
        return c == no_clump ? std::binary_search(ids.begin(), ids.end(), id) : is_listed_clump[c];
    };
    for (std::uint32_t k = 0; k < p.count; ++k)
        if (is_listed(p.id.data()[k]))
            removed_particles.push_back(removed_at(k, RemovedParticle::none));
        else
            kept.push_back(k);
    if (kept.size() == p.count) return;
    const auto is_removed_one = [&](const AttachedParticle& a) {
        return std::binary_search(ids.begin(), ids.end(), a.id);
    };
    if (std::erase_if(attached, is_removed_one) > 0) attached_changed = true;
    if (attached.empty()) posed.clear();
    keep_particles(kept, first);
    invalidate_neighbours();
}

/// Keeps the particles with these indices. The others are in removed_particles from `first` on. The list of
/// pairs keeps those in contact only; a neighbour search has to follow.
void World::keep_particles(const std::vector<std::uint32_t>& kept, std::size_t first)
{
    Arrays<par::Cpu>& a = engine->arrays();
    Particles<par::Cpu>& p = a.particle;
    if (kept.size() == p.count) return;
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> new_index(p.count, none);
    for (std::uint32_t k = 0; k < kept.size(); ++k) new_index[kept[k]] = k;
    std::sort(removed_particles.begin() + static_cast<std::ptrdiff_t>(first), removed_particles.end(),
              [](const RemovedParticle& x, const RemovedParticle& y) { return x.id < y.id; });
    for (std::size_t k = first; k < removed_particles.size(); ++k)
        ++total_outflow.count, total_outflow.mass += removed_particles[k].mass;

    keep(p.position, kept), keep(p.velocity, kept), keep(p.omega, kept), keep(p.compensation, kept);
    keep(p.species, kept), keep(p.id, kept), keep(p.acc, kept), keep(p.alpha, kept);
    keep(p.orientation, kept), keep(p.orientation_compensation, kept), keep(p.position_at_build, kept);
    p.count = static_cast<std::uint32_t>(kept.size());
    inserted_count = kept.size();
    std::vector<std::uint32_t> kept_clumps;
    for (std::uint32_t k = 0; k < p.count; ++k)
        if (const std::uint32_t c = clump_of(p.id.data()[k]);
            c != no_clump && a.clump.data()[c].first_id == p.id.data()[k])
            kept_clumps.push_back(c);
    std::sort(kept_clumps.begin(), kept_clumps.end());
    keep(a.clump, kept_clumps);
    update_clump_tables();

    Pairs<par::Cpu>& pairs = a.pairs;
    std::vector<std::uint32_t> rows;
    const auto is_boundary = [](std::uint32_t j) { return (j & PairView::boundary_bit) != 0; };
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        std::uint32_t &i = pairs.i.data()[n], &j = pairs.j.data()[n];
        if (pairs.in_contact.data()[n] == 0 || new_index[i] == none ||
            (!is_boundary(j) && new_index[j] == none))
            continue;
        i = new_index[i];
        if (!is_boundary(j)) j = new_index[j];
        rows.push_back(n);
    }
    keep(pairs.i, rows), keep(pairs.j, rows), keep(pairs.in_contact, rows), keep(pairs.history, rows);
    keep(pairs.rotation_history, rows), keep(pairs.internal, rows);
    pairs.count = static_cast<std::uint32_t>(rows.size());
    engine->arrays_modified();
    start_balance();
}

}  // namespace hilda::granular
