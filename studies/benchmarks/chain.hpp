// SPDX-License-Identifier: GPL-3.0-or-later
/// The N-bar pendulum with its consistent initial state, for the benchmarks.

#pragma once

#include "dae/model_file.hpp"
#include "studies/framework/problem.hpp"

#include <map>

namespace hilda::studies {

/// The model with `bars` bars; constructed once for each number
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

}  // namespace hilda::studies
