// SPDX-License-Identifier: GPL-3.0-or-later
// Memory, prefix sum and sort on the CPU.
#include "granular/backend/par.hpp"

#include <thrust/execution_policy.h>
#include <thrust/scan.h>
#include <thrust/sort.h>
#if THRUST_DEVICE_SYSTEM == THRUST_DEVICE_SYSTEM_OMP
#include <thrust/system/omp/execution_policy.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace hilda::granular::par {

void* allocate(Cpu, std::size_t bytes)
{
    if (bytes == 0) return nullptr;
    // Huge pages: the loops access a dozen arrays at once. With small pages a step of 50 000 particles takes
    // twice the time.
    constexpr std::size_t huge = 2 << 20;
    const auto round_up = [&](std::size_t to) { return (bytes + to - 1) / to * to; };
    // The last huge page is used if it is mostly full, so that at most a quarter of the memory is unused.
    const bool fills = 5 * bytes >= 4 * round_up(huge);
    const std::size_t rounded = fills ? round_up(huge) : round_up(64);
    void* memory = std::aligned_alloc(fills || bytes > huge ? huge : 64, rounded);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (rounded >= huge) madvise(memory, rounded / huge * huge, MADV_HUGEPAGE);
#endif
    return memory;
}
void release(Cpu, void* memory) noexcept { std::free(memory); }
void copy_bytes(Cpu, void* to, const void* from, std::size_t bytes)
{
    if (bytes > 0) std::memcpy(to, from, bytes);
}

namespace {

constexpr std::size_t serial_below = 2048;  // starting threads costs more than these elements

}

std::uint64_t exclusive_scan(Cpu, const std::uint32_t* in, std::uint32_t* out, std::size_t n)
{
    out[0] = 0;
    if (n <= serial_below)
        thrust::inclusive_scan(thrust::seq, in, in + n, out + 1);
    else
        thrust::inclusive_scan(thrust::device, in, in + n, out + 1);
    return out[n];
}

void stable_sort_by_key(Cpu, std::uint32_t* keys, std::uint32_t* values, std::size_t n, int /*bits*/)
{
    if (n <= serial_below)
        thrust::stable_sort_by_key(thrust::seq, keys, keys + n, values);
    else
        thrust::stable_sort_by_key(thrust::device, keys, keys + n, values);
}

}  // namespace hilda::granular::par
