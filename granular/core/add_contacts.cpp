// SPDX-License-Identifier: GPL-3.0-or-later
// The sums over contacts on the CPU. The file depends on the list of the laws.
#include "granular/core/add_contacts.hpp"

namespace hilda::granular {

void add_contacts(par::Cpu cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws,
                  ContactPart* out)
{
    const auto unit = static_cast<float>(particles.grid.unit);
    par::for_each(cpu, watch_blocks(pairs.count),
                  detail::AddContacts{particles, pairs, laws, 1 / unit, unit, out}, 16);
}

}  // namespace hilda::granular
