// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads and time integration on the CPU in one pass: the particles of a block are advanced as soon as their
/// loads are complete, while their data are in the cache. The loads of most pairs are never stored.
///
/// A particle is advanced after all pairs that need its present state are evaluated. The pairs of a block are
/// those of its rows, and most of their particles j follow in the same or in later blocks. The other pairs
/// are evaluated before the pass, by find_listed_loads().
///
/// The loads of a particle are added in the order of its pairs, as in advance(), so that the results of the
/// two are bitwise equal, for any number of threads.

#pragma once

#include "granular/core/integrator.hpp"

#include <vector>

namespace hilda::granular {

/// Pairs per task of find_listed_loads()
constexpr std::uint32_t list_chunk = 256;

/// The same as find_loads(), for a list of pairs
void find_listed_loads(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                       const std::uint32_t* list, std::uint32_t count);

/// The order of a pass over the particles, for one neighbour list.
///
/// The blocks are divided into ranges; a thread processes the blocks of a range in their order. Evaluated
/// before the pass are the pairs
/// - with a boundary, so that the loads on boundaries are known before the pass,
/// - whose particle j is in an earlier block or in another range than i,
/// - if wanted, those with a fixed particle.
class SweepPlan {
public:
    static constexpr std::uint32_t block = 128;  ///< particles of a block

    /// Plans a pass with up to `threads` ranges.
    void make(const Particles<par::Cpu>& particles, const Pairs<par::Cpu>& pairs, int threads,
              bool fixed_ahead);

    /// For how many threads the pass was planned; 0 if there is no plan
    int threads() const { return planned_threads; }
    /// Discards the plan.
    void reset() { planned_threads = 0; }

    std::uint32_t ranges() const { return static_cast<std::uint32_t>(first_block.size() - 1); }

    std::vector<std::uint32_t> first_block;  ///< of each range, and the number of blocks
    std::vector<std::uint8_t> ahead;         ///< by pair: 1 if it is evaluated before the pass
    std::vector<std::uint32_t> list;         ///< the pairs that are evaluated before the pass
    /// Those of them with i < j, by the range of j, and with j < i, by the block of j: the loads of a
    /// particle j from the first ones precede those of the pairs of the pass, the last ones follow them.
    std::vector<std::uint32_t> early_start, early, late_start, late;

    /// Sums of the loads of the pairs in which a particle is j; zero between the steps
    par::Array<par::Cpu, Load> sum_j;
    par::Array<par::Cpu, Float4> torque_j;  ///< those of the torques; empty without laws of rolling and spin

    std::size_t bytes() const;

private:
    int planned_threads = 0;
};

/// Evaluates the pairs that are not in SweepPlan::list and advances the particles. The loads of the pairs of
/// the list must have been computed. Returns the same as advance().
///
/// `largest_overlap` of `pairs` has at least one element per block.
float sweep(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
            const AdvanceView& arrays, SweepPlan& plan, std::uint32_t count);

}  // namespace hilda::granular
