// SPDX-License-Identifier: GPL-3.0-or-later
/// The family n_pendulum_N.

#pragma once

#include "studies/problem.hpp"

namespace hilda::studies {

inline constexpr int most_bars = 100000;

/// N bars on ball joints, 1 ≤ N ≤ most_bars, under this name
Problem n_pendulum(int N, const std::string& name);

}  // namespace hilda::studies
