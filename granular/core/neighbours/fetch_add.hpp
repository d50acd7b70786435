// SPDX-License-Identifier: GPL-3.0-or-later
/// Atomic addition, on the CPU and on a GPU.

#pragma once

#include "granular/backend/real.hpp"

#include <cstdint>

namespace hilda::granular::detail {

/// Atomic addition; returns the previous value.
HILDA_HD inline std::uint32_t fetch_add(std::uint32_t* counter, std::uint32_t n)
{
#ifdef __CUDA_ARCH__
    return atomicAdd(counter, n);
#else
    return __atomic_fetch_add(counter, n, __ATOMIC_RELAXED);
#endif
}

}  // namespace hilda::granular::detail
