// SPDX-License-Identifier: GPL-3.0-or-later
/// The family n_pendulum_N.

#pragma once

#include "studies/framework/problem.hpp"

#include <cstdint>

namespace hilda::studies {

inline constexpr int most_bars = 100000;

/// N bars on ball joints, 1 ≤ N ≤ most_bars, under this name
Problem n_pendulum(int N, const std::string& name);

/// The same chain, each bar spinning about its own long axis, on which its joints lie: no joint moves. Rates
/// are uniform in ±10 rad/s, from the seed, the first bars of a longer chain as those of a shorter one.
Problem spinning_n_pendulum(int N, std::uint64_t seed);
/// These rates [rad/s]
std::vector<double> spins(int N, std::uint64_t seed);

}  // namespace hilda::studies
