// SPDX-License-Identifier: GPL-3.0-or-later
/// The loops over particles and pairs on the CPU that determine the time of a step, for one set of vector
/// instructions.
///
/// The units in granular_loop_files (loops.cmake) are compiled once for each set. Every copy gives the same
/// bits: packs are computed elementwise, the order of sums does not depend on the number of lanes, and no
/// multiplication is fused with an addition.

#pragma once

#include "granular/core/neighbours/neighbours.hpp"
#include "granular/core/surfaces/triangle_contacts.hpp"
#include "granular/core/sweep.hpp"
#include "granular/core/watch.hpp"

namespace hilda::granular {

struct CpuLoops {
    void (*find_listed_loads)(par::Cpu, const ParticleView&, const PairView&, const LawView&,
                              const std::uint32_t* list, std::uint32_t count);
    float (*sweep)(par::Cpu, const ParticleView&, const PairView&, const LawView&, const AdvanceView&,
                   SweepPlan&, std::uint32_t count);
    float (*advance_before_loads)(par::Cpu, std::uint32_t particles, const AdvanceView&);
    void (*find_neighbours)(Neighbours<par::Cpu>&, const SearchInput&, Particles<par::Cpu>&,
                            Pairs<par::Cpu>&);
    void (*list_triangles)(TriangleContacts&, const PairView&, const Surfaces&, const std::uint32_t* which,
                           std::uint32_t count);
    void (*find_triangle_loads)(TriangleContacts&, const ParticleView&, const PairView&, const LawView&,
                                const std::uint32_t* start, double path);
    void (*add_contacts)(par::Cpu, const ParticleView&, const PairView&, const LawView&, ContactPart* out);
};

}  // namespace hilda::granular
