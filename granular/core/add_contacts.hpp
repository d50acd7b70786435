// SPDX-License-Identifier: GPL-3.0-or-later
/// Energies of the contact springs and the number of deep contacts; see watch.hpp.

#pragma once

#include "granular/core/watch.hpp"

namespace hilda::granular::detail {

/// Contact sums of a block of pairs
struct AddContacts {
    ParticleView particles;
    PairView pairs;
    LawView laws;
    float units_per_metre, unit;
    ContactPart* out;

    /// Sets what the energies depend on: overlap, normal, radii and masses.
    HILDA_HD bool find(ContactPoint<float>& contact, std::uint32_t n) const
    {
        const std::uint32_t i = pairs.i[n], j = pairs.j[n];
        const Float4 v_i = particles.velocity[i], w_i = particles.omega[i];
        if ((j & PairView::boundary_bit) != 0)
            return find_boundary_contact(contact, particles.grid, particles.position[i], v_i, w_i,
                                         laws.surfaces, j & ~PairView::boundary_bit);
        const Float4 v_j = particles.velocity[j], w_j = particles.omega[j];
        const Difference d = pair_difference(particles, pairs, n);
        const std::int64_t D = radius_in_units(v_i.w, units_per_metre) +
                               radius_in_units(v_j.w, units_per_metre),
                           x = d.x, y = d.y, z = d.z, d2 = x * x + y * y + z * z, q = D * D - d2;
        set_overlap(contact, static_cast<float>(q), static_cast<float>(d2), static_cast<float>(D),
                    Vec<float>{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
                    unit);
        contact.R_i = v_i.w, contact.R_j = v_j.w;
        set_masses(contact, w_i.w, w_j.w);
        return q > 0;
    }

    HILDA_HD void operator()(std::uint32_t block) const
    {
        ContactPart sum;
        DoublePart normal, tangential;
        const std::uint32_t end = end_of_block(block, pairs.count);
        for (std::uint32_t n = block * watch_block; n < end; ++n) {
            ContactPoint<float> contact{};
            if (pairs.in_contact[n] == 0 || particles.is_ghost(pairs.i[n]) || !find(contact, n)) continue;
            contact.v_n = 0, contact.h = laws.h;
            const Float4 u = pairs.history[n];
            History<float> history{{u.x, u.y, u.z}, abs(u.w), {0, 0, 0}, 0, u.w < 0};
            const bool rotation_laws = pairs.rotation_history != nullptr;
            if (rotation_laws) {
                const Float4 psi = pairs.rotation_history[n];
                history.psi = {psi.x, psi.y, psi.z}, history.spin = psi.w;
            }
            if (pairs.internal != nullptr) set_internal(history, pairs.internal[n]);
            const ElasticEnergy<float> U = elastic_energy(laws.law[pairs.law == nullptr ? 0 : pairs.law[n]],
                                                          contact, history, rotation_laws);
            normal.add(U.normal, sum.normal), tangential.add(U.tangential, sum.tangential);
            const float R = contact.R_j > 0 ? smaller(contact.R_i, contact.R_j) : contact.R_i;
            sum.contacts += 1, sum.deep += contact.delta > deep_overlap * R ? 1 : 0;
        }
        normal.finish(sum.normal), tangential.finish(sum.tangential);
        out[block] = sum;
    }
};

}  // namespace hilda::granular::detail
