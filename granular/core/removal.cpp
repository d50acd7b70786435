// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/removal.hpp"

#include "granular/core/clump.hpp"
#include "granular/core/contact_loop.hpp"

#include <algorithm>

namespace hilda::granular {

LeavingParticle leaving_particle(const Particles<par::Cpu>& p, std::uint32_t k)
{
    return {.position = p.position.data()[k],
            .velocity = p.velocity.data()[k],
            .omega = p.omega.data()[k],
            .id = p.id.data()[k]};
}

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

std::vector<LeavingParticle> particles_outside(const Particles<par::Cpu>& p, const CellGrid& g)
{
    std::vector<LeavingParticle> all;
    for (std::uint32_t k = 0; k < p.count; ++k)
        if ((p.ghost.size() == 0 || p.ghost.data()[k] == 0) && side_behind(g, p.position.data()[k]) >= 0)
            all.push_back(leaving_particle(p, k));
    std::sort(all.begin(), all.end());
    return all;
}

void remove_particles(Particles<par::Cpu>& p, Pairs<par::Cpu>& pairs, const std::vector<std::uint32_t>& ids)
{
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> kept, new_index(p.count, none);
    kept.reserve(p.count);
    for (std::uint32_t k = 0; k < p.count; ++k) {
        if (std::binary_search(ids.begin(), ids.end(), p.id.data()[k])) continue;
        new_index[k] = static_cast<std::uint32_t>(kept.size());
        kept.push_back(k);
    }
    keep(p.position, kept), keep(p.velocity, kept), keep(p.omega, kept), keep(p.compensation, kept);
    keep(p.species, kept), keep(p.id, kept), keep(p.acc, kept), keep(p.alpha, kept);
    keep(p.orientation, kept), keep(p.orientation_compensation, kept), keep(p.position_at_build, kept);
    keep(p.ghost, kept);
    p.count = static_cast<std::uint32_t>(kept.size());

    const auto is_boundary = [](std::uint32_t j) { return (j & PairView::boundary_bit) != 0; };
    std::vector<std::uint32_t> rows;
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
    keep(pairs.image, rows);
    keep(pairs.rotation_history, rows), keep(pairs.internal, rows);
    pairs.count = static_cast<std::uint32_t>(rows.size());
}

}  // namespace hilda::granular
