// SPDX-License-Identifier: GPL-3.0-or-later
// The table of the loops for the instruction set of this compilation, and the neighbour search on the CPU.
#include "granular/backend/cpu_loops.hpp"

#include "granular/core/neighbours/neighbours_impl.hpp"

#ifndef HILDA_LOOPS  // the name of the instruction set
#define HILDA_LOOPS base
#endif
#define HILDA_JOINED(a, b) a##b
#define HILDA_TABLE_OF(name) HILDA_JOINED(hilda_granular_loops_, name)

namespace hilda::granular {

template class Neighbours<par::Cpu>;

namespace {

constexpr CpuLoops loops{
    .find_listed_loads = find_listed_loads,
    .sweep = sweep,
    .advance_before_loads = advance_before_loads,
    .find_neighbours = [](Neighbours<par::Cpu>& neighbours, const SearchInput& input,
                          Particles<par::Cpu>& particles,
                          Pairs<par::Cpu>& pairs) { neighbours.find(input, particles, pairs); },
    .list_triangles = [](TriangleContacts& of, const PairView& pairs, const Surfaces& surfaces,
                         const std::uint32_t* which,
                         std::uint32_t count) { of.list(pairs, surfaces, which, count); },
    .find_triangle_loads =
        [](TriangleContacts& of, const ParticleView& particles, const PairView& pairs, const LawView& laws,
           const std::uint32_t* start,
           double path) { of.find_loads(par::Cpu(), particles, pairs, laws, start, path); },
    .add_contacts = add_contacts};

}  // namespace

}  // namespace hilda::granular

/// The only global symbol of the units of an instruction set, see loops.cmake
extern "C" const hilda::granular::CpuLoops* HILDA_TABLE_OF(HILDA_LOOPS)() { return &hilda::granular::loops; }
