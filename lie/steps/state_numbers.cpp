// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/state_numbers.hpp"

namespace hilda::lie {

void copy(const State& from, State& to)
{
    to.t = from.t;
    to.body = from.body;
    to.alpha = from.alpha;
    to.lambda = from.lambda;
    to.discrete_state = from.discrete_state;
    to.internal_state = from.internal_state;
    to.applied_loads = from.applied_loads;
    to.cone_forces = from.cone_forces;
    to.derived = from.derived;
}

}  // namespace hilda::lie
