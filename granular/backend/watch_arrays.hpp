// SPDX-License-Identifier: GPL-3.0-or-later
/// The arrays of an engine for the watch over a run, and the sums over them. See Engine and core/watch.hpp.

#pragma once

#include "granular/backend/cpu_loops.hpp"
#include "granular/backend/pair_lists.hpp"
#include "granular/backend/transfer.hpp"

#include <utility>

namespace hilda::granular {

namespace detail {

/// 1 for a fixed particle, for par::largest
struct IsFixed {
    const Float4* omega;
    HILDA_HD float operator()(std::uint32_t k) const { return omega[k].w > 0 ? 0 : 1; }
};

}  // namespace detail

template <class Backend>
class WatchArrays {
public:
    /// Lists the pairs with external loads and provides the memory of the sums, after a neighbour search.
    void prepare(const Backend& on, const Arrays<Backend>& all, bool has_boundaries,
                 detail::PairLister<Backend>& lister)
    {
        const std::uint32_t n = all.particle.count, pairs = all.pairs.count;
        const Float4* const omega = all.particle.omega.data();
        boundary_pairs = fixed_pairs = 0;
        if (has_boundaries)
            boundary_pairs = lister.list_pairs(on, HasBoundary{all.pairs.j.data()}, pairs, with_boundary);
        if (par::largest(on, n, detail::IsFixed{omega}) > 0)
            fixed_pairs = lister.list_pairs(
                on, HasFixedParticle{all.pairs.i.data(), all.pairs.j.data(), omega, ghosts(all.particle)},
                pairs, with_fixed);
        velocities_copy.resize(n);
        particle_blocks.resize(watch_blocks(n)), kinetic_blocks.resize(watch_blocks(n));
        contact_blocks.resize(watch_blocks(pairs));
        external_blocks.resize(watch_blocks(boundary_pairs) + watch_blocks(fixed_pairs));
    }

    /// Provides `count` numbers for the overlaps that the tasks of a loop have found.
    void resize_overlaps(const Backend& on, std::size_t count)
    {
        earlier_overlap = take_largest_overlap(on);
        overlap.resize(count);
        par::fill(on, overlap.data(), overlap.size(), 0.f);
    }
    float* overlaps() { return overlap.data(); }

    float take_largest_overlap(const Backend& on)
    {
        float largest = std::exchange(earlier_overlap, 0.f);
        for (const float of_task : detail::to_host(on, overlap, host_overlaps))
            largest = larger(largest, of_task);
        par::fill(on, overlap.data(), overlap.size(), 0.f);
        return largest;
    }

    ExternalPart external_sums(const Backend& on, const ParticleView& particles, const PairView& pairs,
                               const Surfaces& surfaces, const std::vector<BoundaryVelocity>& before,
                               const std::vector<BoundaryVelocity>& after)
    {
        if (external_blocks.size() == 0) return {};
        const bool moves = !before.empty();
        if (moves) detail::send(on, velocities_before, before), detail::send(on, velocities_after, after);
        const std::uint32_t blocks = watch_blocks(boundary_pairs);
        if (boundary_pairs > 0)
            par::for_each(on, blocks,
                          AddBoundaryLoads{.particles = particles,
                                           .pairs = pairs,
                                           .surfaces = surfaces,
                                           .before = moves ? velocities_before.data() : nullptr,
                                           .after = moves ? velocities_after.data() : nullptr,
                                           .which = with_boundary.data(),
                                           .count = boundary_pairs,
                                           .out = external_blocks.data()},
                          serial_blocks);
        if (fixed_pairs > 0)
            par::for_each(on, watch_blocks(fixed_pairs),
                          AddFixedLoads{particles, pairs, with_fixed.data(), fixed_pairs,
                                        external_blocks.data() + blocks},
                          serial_blocks);
        return detail::total(on, external_blocks, host_external_blocks);
    }

    ParticlePart particle_sums(const Backend& on, const ParticleView& view, const Particles<Backend>& p,
                               const Float4* force, const ClumpView& clumps, bool only_forces)
    {
        par::for_each(on, particle_blocks.size(),
                      AddParticles{.particles = view,
                                   .copy = only_forces ? nullptr : velocities_copy.data(),
                                   .force = force,
                                   .id = p.id.data(),
                                   .count = p.count,
                                   .out = particle_blocks.data(),
                                   .clumps = clumps},
                      serial_blocks);
        return detail::total(on, particle_blocks, host_particle_blocks);
    }

    ContactPart contact_sums(const Backend& on, const ParticleView& particles, const PairView& pairs,
                             const LawView& laws, [[maybe_unused]] const CpuLoops* loops)
    {
        if constexpr (std::is_same_v<Backend, par::Cpu>)
            loops->add_contacts(on, particles, pairs, laws, contact_blocks.data());
        else
            add_contacts(on, particles, pairs, laws, contact_blocks.data());
        return detail::total(on, contact_blocks, host_contact_blocks);
    }

    KineticPart kinetic_sums(const Backend& on, const Particles<Backend>& p, const ClumpView& clumps,
                             double s)
    {
        par::for_each(on, kinetic_blocks.size(),
                      AddKinetic{.velocity = p.velocity.data(),
                                 .omega = p.omega.data(),
                                 .before = velocities_copy.data(),
                                 .s = s,
                                 .count = p.count,
                                 .out = kinetic_blocks.data(),
                                 .clumps = clumps,
                                 .ghost = ghosts(p)},
                      serial_blocks);
        return detail::total(on, kinetic_blocks, host_kinetic_blocks);
    }

    std::size_t bytes() const
    {
        return with_boundary.bytes() + with_fixed.bytes() + velocities_copy.bytes() +
               particle_blocks.bytes() + kinetic_blocks.bytes() + contact_blocks.bytes() +
               external_blocks.bytes() + overlap.bytes() + velocities_before.bytes() +
               velocities_after.bytes();
    }

private:
    static constexpr std::size_t serial_blocks = 16;

    static const std::uint8_t* ghosts(const Particles<Backend>& p)
    {
        return p.ghost.size() > 0 ? p.ghost.data() : nullptr;
    }

    std::uint32_t boundary_pairs = 0, fixed_pairs = 0;
    par::Array<Backend, std::uint32_t> with_boundary, with_fixed;  ///< numbers of these pairs
    par::Array<Backend, Velocities> velocities_copy;
    par::Array<Backend, BoundaryVelocity> velocities_before, velocities_after;
    par::Array<Backend, float> overlap;
    /// Largest overlap since the last call of take_largest_overlap() and before the last neighbour search
    float earlier_overlap = 0;
    par::Array<Backend, ParticlePart> particle_blocks;
    par::Array<Backend, KineticPart> kinetic_blocks;
    par::Array<Backend, ContactPart> contact_blocks;
    par::Array<Backend, ExternalPart> external_blocks;
    std::vector<ParticlePart> host_particle_blocks;
    std::vector<KineticPart> host_kinetic_blocks;
    std::vector<ContactPart> host_contact_blocks;
    std::vector<ExternalPart> host_external_blocks;
    std::vector<float> host_overlaps;
};

}  // namespace hilda::granular
