// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads and time integration on the CPU in one pass: the particles of a block are advanced as soon as their
/// loads are complete, while their data are in the cache. The loads of most pairs are never stored.
///
/// A particle is advanced after all pairs that need its present state are evaluated. The pairs of a block are
/// those of its rows, and most of their particles j follow in the same or in later blocks. The other pairs
/// are evaluated before the pass, by find_listed_loads(). Only their loads are stored.
///
/// The loads of a particle are added in the order of its pairs, as in advance() of the other back ends, so
/// that the result does not depend on the number of threads.

#pragma once

#include "granular/core/integrator.hpp"

#include <cstring>
#include <vector>

namespace hilda::granular {

/// Pairs per task of find_listed_loads()
constexpr std::uint32_t list_chunk = 256;

/// The same as find_loads(), for a list of pairs; they are marked in pairs.stored.
void find_listed_loads(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                       const std::uint32_t* list, std::uint32_t count);

/// The order of a pass over the particles, for one neighbour list.
///
/// The blocks are divided into ranges; a thread processes the blocks of a range in their order. Evaluated
/// before the pass are the pairs
/// - with a boundary, so that the loads on boundaries are known before the pass,
/// - whose particle j is in an earlier block or in another range than i,
/// - if wanted, those with a fixed particle, or all.
class SweepPlan {
public:
    /// Pairs that are evaluated before the pass in addition to those that have to be
    enum class Ahead {
        none,
        with_fixed,  ///< those with a fixed particle
        all          ///< all; advance() can be called more than once with the same loads
    };
    static constexpr std::uint32_t block = 128;  ///< particles of a block

    /// Plans a pass with up to `threads` ranges, and provides the memory of the loads of the list in `pairs`.
    void make(const Particles<par::Cpu>& particles, Pairs<par::Cpu>& pairs, int threads, Ahead ahead);

    /// Whether there is a plan, and it was made with these arguments
    bool is_for(int threads, Ahead ahead) const { return planned_threads == threads && planned == ahead; }
    /// Discards the plan.
    void reset() { planned_threads = 0; }

    std::uint32_t ranges() const { return static_cast<std::uint32_t>(first_block.size() - 1); }

    std::vector<std::uint32_t> first_block;  ///< of each range, and the number of blocks
    std::vector<std::uint32_t> list;         ///< the pairs that are evaluated before the pass
    /// Pairs of two particles of the list. `early`: particle i is in an earlier range than j; ordered by the
    /// range of j, and added before it. `late`: i is in a later block than j; ordered by the block of j, and
    /// added after the pairs of this block. The others are added in the pass, at their place.
    std::vector<std::uint32_t> early_start, early, late_start, late;
    /// The pairs of the list, in their order, as bits
    StoredLoads stored() const { return {marks.data(), marks_before.data()}; }
    /// The marks of 16 pairs from n on, in the lowest bits
    unsigned marks_from(std::uint32_t n) const
    {
        std::uint32_t bits = 0;
        std::memcpy(&bits, reinterpret_cast<const char*>(marks.data()) + n / 8, sizeof bits);
        return bits >> n % 8 & 0xFFFF;
    }
    /// Sums of the loads of the pairs in which a particle is j; zero between the steps
    par::Array<par::Cpu, Load> sum_j;
    par::Array<par::Cpu, Float4> torque_j;  ///< those of the torques; empty without laws of rolling and spin

    std::size_t bytes() const;

private:
    int planned_threads = 0;
    Ahead planned = Ahead::none;
    std::vector<std::uint64_t> marks;         ///< see StoredLoads
    std::vector<std::uint32_t> marks_before;  ///< see StoredLoads
};

/// Evaluates the pairs that are not in SweepPlan::list and advances the particles. The loads of the pairs of
/// the list must have been computed. Returns the same as advance() of the other back ends.
///
/// `largest_overlap` of `pairs` has at least one element per block.
float sweep(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
            const AdvanceView& arrays, SweepPlan& plan, std::uint32_t count);

/// Advances the particles in Part::before_loads, which needs no loads. Returns the same as sweep().
float advance_before_loads(par::Cpu, std::uint32_t particles, const AdvanceView& arrays);

}  // namespace hilda::granular
