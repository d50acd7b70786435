// SPDX-License-Identifier: GPL-3.0-or-later
/// Removal of particles from the arrays of a world.

#pragma once

#include "granular/core/neighbours/neighbours.hpp"

#include <cstdint>
#include <vector>

namespace hilda::granular {

/// What the record of a removed particle needs of it; see Particles
struct LeavingParticle {
    Position position;
    Float4 velocity, omega;
    std::uint32_t id = 0;

    bool operator<(const LeavingParticle& o) const { return id < o.id; }
};

LeavingParticle leaving_particle(const Particles<par::Cpu>& p, std::uint32_t k);

/// The side of the domain behind which a position is, 2 axis or 2 axis + 1, that with the largest distance;
/// -1 if it is inside. The condition is that of the neighbour search.
int side_behind(const CellGrid& g, const Position& p);

/// The particles outside the domain, ordered by id. Copies of particles of other processes are not among
/// them.
std::vector<LeavingParticle> particles_outside(const Particles<par::Cpu>& p, const CellGrid& g);

/// Removes the particles with these ids, which are in ascending order. Keeps the order of the others, and of
/// their pairs those in contact. A neighbour search has to follow.
void remove_particles(Particles<par::Cpu>& p, Pairs<par::Cpu>& pairs, const std::vector<std::uint32_t>& ids);

/// Keeps the elements of an array that `index` lists, in ascending order. An empty array stays empty.
template <class Array>
void keep(Array& values, const std::vector<std::uint32_t>& index)
{
    if (values.size() == 0) return;
    for (std::size_t k = 0; k < index.size(); ++k) values.data()[k] = values.data()[index[k]];
    values.resize(index.size());
}

}  // namespace hilda::granular
