// SPDX-License-Identifier: GPL-3.0-or-later
/// The difference of the motions of two states.

#pragma once

#include "lie/state.hpp"

#include <algorithm>

namespace hilda::tests {

/// Largest difference of r, A, ṙ and ω̄ over all bodies
inline double motion_difference(const lie::State& a, const lie::State& b)
{
    double largest = 0;
    for (size_t k = 0; k < a.body.size(); ++k)
        largest = std::max({largest, (a.body[k].r - b.body[k].r).norm(), (a.body[k].A - b.body[k].A).norm(),
                            (a.body[k].rdot - b.body[k].rdot).norm(),
                            (a.body[k].omega_bar - b.body[k].omega_bar).norm()});
    return largest;
}

}  // namespace hilda::tests
