// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs a model and calls a function at every node.
#pragma once

#include "dae/model.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"

#include <functional>

namespace hilda::tests {

using NodeFunction = std::function<void(const lie::State&)>;

/// The state after t with steps of h; on_node is called with every node, filled in (see
/// Integrator::fill_node)
inline lie::State march(
    const dae::Model& model, const lie::State& x, const std::string& scheme, double t, double h,
    const NodeFunction& on_node = [](const lie::State&) {},
    const lie::Settings& settings = {.tolerance = 1e-13})
{
    struct NodeObserver final : lie::Observer {
        explicit NodeObserver(const NodeFunction& on_node) : on_node(on_node) {}
        void accepted(const lie::State& node, long, int) override { on_node(node); }
        const NodeFunction& on_node;
    } node_observer(on_node);
    const auto integrator = lie::scheme(scheme).make(model, settings);
    lie::Observer* all[] = {&node_observer};
    return lie::march(x, *integrator, lie::TimeGrid::over(t, h, t), all).row.back();
}

}  // namespace hilda::tests
