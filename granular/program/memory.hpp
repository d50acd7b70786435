// SPDX-License-Identifier: GPL-3.0-or-later
/// Available memory.

#pragma once

#include <cstddef>

namespace hilda::granular {

/// Smallest of the available memory of the machine, the remaining memory of the control groups of this
/// process and the remaining address space (`ulimit -v`) [bytes]. The largest number of the type if none of
/// them can be read.
std::size_t available_memory();

}  // namespace hilda::granular
