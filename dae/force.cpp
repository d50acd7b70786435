// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/force.hpp"

#include "lie/schemes.hpp"

namespace hilda::dae {

bool Force::is_implicit_in(const lie::Scheme& scheme) const
{
    return implicit && scheme.supports.contains(lie::Feature::springs);
}

double Force::stable_step_in(const lie::Scheme& scheme, const State& x, std::span<const int> near) const
{
    return is_implicit_in(scheme) ? std::numeric_limits<double>::infinity()
                                  : scheme.stability / 2 * stable_step_with(x, scheme.loads, near);
}

}  // namespace hilda::dae
