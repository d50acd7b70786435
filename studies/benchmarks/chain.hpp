// SPDX-License-Identifier: GPL-3.0-or-later
/// Chains of bars with their consistent initial state, for the benchmarks.

#pragma once

#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "studies/framework/problem.hpp"

#include <map>
#include <memory>

namespace hilda::studies {

/// The N-bar pendulum with spherical joints; constructed once for each number
inline const dae::Description& chain(long bars)
{
    static std::map<long, dae::Description> made;
    if (!made.count(bars)) {
        const std::string name = "n_pendulum_" + std::to_string(bars);
        dae::Description d = dae::read_model(problem(name).model, name);
        dae::start(d);
        made.emplace(bars, std::move(d));
    }
    return made.at(bars);
}

/// The same bars on hinges about y, from rest along x: a motion in the plane; constructed once for each
/// number
inline const dae::Description& hinge_chain(long bars)
{
    static std::map<long, dae::Description> made;
    if (!made.count(bars)) {
        dae::Description d;
        d.model = std::make_unique<dae::Model>();
        d.model->gravity = {0, 0, -9.81};
        const dae::Vec3 Y = dae::Vec3::UnitY(), end(1, 0, 0);
        for (int b = 0; b < bars; ++b) {
            d.model->add({.name = "bar_" + std::to_string(b + 1),
                          .m = 39,
                          .J_bar = dae::Vec3(0.01625, 13.008125, 13.008125).asDiagonal()});
            d.x.body.emplace_back().r = {2. * b + 1, 0, 0};
            d.model->constrain("hinge_" + std::to_string(b + 1),
                               dae::revolute(b - 1, b == 0 ? dae::Vec3(0, 0, 0) : end, Y, b, -end, Y));
        }
        dae::start(d);
        made.emplace(bars, std::move(d));
    }
    return made.at(bars);
}

}  // namespace hilda::studies
