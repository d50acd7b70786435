// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/pivot_node.hpp"

#include "lie/integrator.hpp"

namespace hilda::run {

void PivotNode::accepted(const lie::State& x, long, int)
{
    const long factorizations = integrator.statistics().factorizations;
    if (factorizations == last_count) return;
    last_count = factorizations;
    node = integrator.pivots() != nullptr ? *integrator.pivots() : x;
}

void PivotNode::restore(const lie::State& from, double h)
{
    node = from;
    if (node.body.empty()) return;
    try {
        if (integrator.pivots() != nullptr) {
            integrator.choose_pivots(node, h);
        } else {
            lie::State discarded = node;
            integrator.step(discarded, h);
        }
    } catch (const lie::NumericalFailure&) {
        // The pivots are chosen before the step can fail, and only they are needed.
    }
    last_count = integrator.statistics().factorizations;
}

}  // namespace hilda::run
