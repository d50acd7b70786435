// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/outputs/turn_counter.hpp"

namespace hilda::dae {

void TurnCounter::count(const State& before, State& after) const
{
    const double expected = angle(before) + 0.5 * (after.t - before.t) * (rate(before) + rate(after));
    store(nearest_angle(after, expected), after);
}

}  // namespace hilda::dae
