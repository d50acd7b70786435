// SPDX-License-Identifier: GPL-3.0-or-later
/// The family of problems n_pendulum_N: chains of N bars with spherical joints.

#pragma once

#include "studies/framework/problem.hpp"

#include <cstdint>

namespace hilda::studies {

inline constexpr int most_bars = 100000;

/// The problem with N bars, 1 ≤ N ≤ most_bars, and this name
Problem n_pendulum(int N, const std::string& name);

/// The same chain with an initial spin of each bar about its long axis, which contains its joints, so that
/// the joints are at rest. The spins are those of spins(N, seed).
Problem spinning_n_pendulum(int N, std::uint64_t seed);
/// Random spins, uniform in ±10 rad/s. The first values do not depend on N.
std::vector<double> spins(int N, std::uint64_t seed);

}  // namespace hilda::studies
