// SPDX-License-Identifier: GPL-3.0-or-later
/// The family of problems n_four_bar_N: mechanisms of N four-bar windows.

#pragma once

#include "studies/framework/problem.hpp"

namespace hilda::studies {

inline constexpr int most_windows = 10000;

/// The problem with N windows, 1 ≤ N ≤ most_windows, and this name
Problem n_four_bar(int N, const std::string& name);

}  // namespace hilda::studies
