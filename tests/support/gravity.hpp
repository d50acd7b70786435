// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace hilda::tests {

inline constexpr double g = 9.81;  ///< the gravity of a dae::Model by default [m/s²]

}  // namespace hilda::tests
