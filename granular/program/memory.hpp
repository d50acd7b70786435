// SPDX-License-Identifier: GPL-3.0-or-later
/// How much memory a run may take.

#pragma once

#include <cstddef>

namespace hilda::granular {

/// The least of what the machine has free, what the control groups of this process leave it and what `ulimit -v` does
/// [bytes]; the largest number where nothing tells
std::size_t available_memory();

}  // namespace hilda::granular
