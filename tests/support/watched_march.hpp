// SPDX-License-Identifier: GPL-3.0-or-later
/// A march of which a test sees every node.
#pragma once

#include "dae/model.hpp"
#include "lie/trajectory.hpp"

#include <functional>

namespace hilda::tests {

using Look = std::function<void(const lie::State&)>;

/// Where a scheme has brought the model after t, with steps of h; `look` is shown each node, complete.
inline lie::State march(
    const dae::Model& model, const lie::State& x, const std::string& scheme, double t, double h,
    const Look& look = [](const lie::State&) {}, const lie::Settings& settings = {.tolerance = 1e-13})
{
    struct Watch final : lie::Observer {
        explicit Watch(const Look& look) : look(look) {}
        void accepted(const lie::State& node, long, int) override { look(node); }
        const Look& look;
    } watch(look);
    const auto integrator = lie::scheme(scheme).make(model, settings);
    lie::Observer* all[] = {&watch};
    return lie::march(x, *integrator, lie::TimeGrid::over(t, h, t), all).row.back();
}

}  // namespace hilda::tests
