// SPDX-License-Identifier: GPL-3.0-or-later
// Memory, prefix sum and sort on the CPU.
#include "granular/backend/par.hpp"

#include <thrust/execution_policy.h>
#include <thrust/merge.h>
#include <thrust/sort.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <new>
#include <numeric>
#include <vector>

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

constexpr std::size_t serial_below = 2048;  // waking threads costs more than these elements

}  // namespace

std::uint64_t exclusive_scan(Cpu, const std::uint32_t* in, std::uint32_t* out, std::size_t n)
{
    // The sums of the parts, then the numbers within each
    std::uint64_t before[most_parts + 1] = {};
    divide(n, serial_below, [&](std::size_t begin, std::size_t end, int p) {
        before[p + 1] = std::accumulate(in + begin, in + end, std::uint64_t{0});
    });
    std::partial_sum(std::begin(before), std::end(before), std::begin(before));
    out[0] = 0;
    divide(n, serial_below, [&](std::size_t begin, std::size_t end, int p) {
        auto sum = static_cast<std::uint32_t>(before[p]);
        for (std::size_t k = begin; k < end; ++k) out[k + 1] = sum += in[k];
    });
    return out[n];
}

void stable_sort_by_key(Cpu, std::uint32_t* keys, std::uint32_t* values, std::size_t n, int /*bits*/)
{
    // Each part is sorted, then pairs of neighbouring parts are merged.
    std::vector<std::size_t> first(most_parts + 1, n);
    std::size_t parts = 0;
    divide(n, serial_below, [&](std::size_t begin, std::size_t end, int p) {
        thrust::stable_sort_by_key(thrust::seq, keys + begin, keys + end, values + begin);
        first[p] = begin;
    });
    while (first[parts] < n) ++parts;
    if (parts < 2) return;
    std::vector<std::uint32_t> other_keys(n), other_values(n);
    std::uint32_t *from_keys = keys, *from_values = values, *to_keys = other_keys.data(),
                  *to_values = other_values.data();
    for (std::size_t width = 1; width < parts; width *= 2) {
        const std::size_t merges = (parts + 2 * width - 1) / (2 * width);
        for_each(
            Cpu(), merges,
            [&](std::uint32_t m) {
                const auto start = [&](std::size_t part) { return first[std::min(part, parts)]; };
                const std::size_t a = start(2 * m * width), b = start((2 * m + 1) * width),
                                  c = start((2 * m + 2) * width);
                thrust::merge_by_key(thrust::seq, from_keys + a, from_keys + b, from_keys + b, from_keys + c,
                                     from_values + a, from_values + b, to_keys + a, to_values + a);
            },
            1);
        std::swap(from_keys, to_keys), std::swap(from_values, to_values);
    }
    if (from_keys == keys) return;
    std::copy_n(from_keys, n, keys), std::copy_n(from_values, n, values);
}

}  // namespace hilda::granular::par
