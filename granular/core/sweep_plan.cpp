// SPDX-License-Identifier: GPL-3.0-or-later
// The order of a one-pass step.
#include "granular/core/sweep.hpp"

#include <algorithm>
#include <bit>

namespace hilda::granular {

void SweepPlan::make(const Particles<par::Cpu>& particles, Pairs<par::Cpu>& pairs, int threads, Ahead ahead)
{
    planned_threads = threads, planned = ahead;
    const std::uint32_t n = particles.count, blocks = (n + block - 1) / block;
    const std::uint32_t* const start = pairs.start.data();
    // Ranges of about the same work; a range of a few blocks is not worth a thread.
    const std::uint32_t most = std::max(1u, std::min(static_cast<std::uint32_t>(threads), blocks / 4));
    const auto work = [&](std::uint32_t b) {
        const std::uint32_t k = std::min(b * block, n);
        return std::uint64_t{start[k]} + 4 * std::uint64_t{k};
    };
    first_block.assign(1, 0);
    for (std::uint32_t b = 1; b < blocks; ++b)
        if (work(b) * most >= work(blocks) * first_block.size()) first_block.push_back(b);
    first_block.push_back(blocks);

    std::vector<std::vector<std::uint32_t>> lists(ranges());
    par::for_each(
        par::Cpu(), ranges(),
        [&](std::uint32_t r) {
            const std::uint32_t end = std::min(first_block[r + 1] * block, n);
            for (std::uint32_t p = first_block[r] * block; p < end; ++p)
                for (std::uint32_t k = start[p]; k < start[p + 1]; ++k) {
                    const std::uint32_t j = pairs.j.data()[k];
                    const bool boundary = (j & PairView::boundary_bit) != 0;
                    const auto fixed = [&](std::uint32_t a) { return !(particles.omega.data()[a].w > 0); };
                    if (boundary || j < p / block * block || j >= end || ahead == Ahead::all ||
                        (ahead == Ahead::with_fixed && (fixed(p) || fixed(j))))
                        lists[r].push_back(k);
                }
        },
        1);
    list.clear();
    for (auto& of_range : lists) {
        list.insert(list.end(), of_range.begin(), of_range.end());
        of_range = {};
    }

    // SweepPlan::marks_from() reads beyond the last pair.
    marks.assign(pairs.count / 64 + 2, 0), marks_before.assign(marks.size(), 0);
    for (const std::uint32_t k : list) marks[k >> 6] |= std::uint64_t{1} << (k & 63);
    for (std::size_t w = 1; w < marks.size(); ++w)
        marks_before[w] = marks_before[w - 1] + static_cast<std::uint32_t>(std::popcount(marks[w - 1]));
    pairs.load.resize(list.size());
    par::fill(par::Cpu(), pairs.load.data(), list.size(), Load{});
    if (pairs.rotation_history.size() > 0) {
        pairs.torque.resize(list.size());
        par::fill(par::Cpu(), pairs.torque.data(), list.size(), Float4{});
    }

    // Pairs of particles first, then those with each boundary, so that packs have one boundary, then those
    // with triangles. They keep their order otherwise.
    std::uint32_t boundaries = 0;
    const auto surface = [&](std::uint32_t k) { return pairs.j.data()[k] & ~PairView::boundary_bit; };
    const auto has_surface = [&](std::uint32_t k) {
        return (pairs.j.data()[k] & PairView::boundary_bit) != 0;
    };
    for (const std::uint32_t k : list)
        if (has_surface(k) && !Surfaces::is_triangle(surface(k)))
            boundaries = std::max(boundaries, surface(k) + 1);
    const auto boundary_number = [&](std::uint32_t k) {
        return has_surface(k) ? std::min(surface(k), boundaries) + 1 : 0;
    };
    std::vector<std::uint32_t> place(boundaries + 3);
    for (const std::uint32_t k : list) ++place[boundary_number(k) + 1];
    for (std::size_t b = 1; b < place.size(); ++b) place[b] += place[b - 1];
    std::vector<std::uint32_t> by_boundary(list.size());
    for (const std::uint32_t k : list) by_boundary[place[boundary_number(k)]++] = k;
    list.swap(by_boundary);

    std::vector<std::uint32_t> range_of_block(blocks);
    for (std::uint32_t r = 0; r < ranges(); ++r)
        std::fill(range_of_block.begin() + first_block[r], range_of_block.begin() + first_block[r + 1], r);
    // Counting sorts; pairs with the same key keep their order.
    const auto sort = [&](bool is_early, std::size_t keys, const auto& key, std::vector<std::uint32_t>& first,
                          std::vector<std::uint32_t>& sorted) {
        const auto each = [&](const auto& f) {
            for (const std::uint32_t k : list) {
                const std::uint32_t i = pairs.i.data()[k], j = pairs.j.data()[k];
                if ((j & PairView::boundary_bit) != 0) continue;
                const std::uint32_t of_i = i / block, of_j = j / block;
                const bool precedes = i < j && range_of_block[of_i] != range_of_block[of_j],
                           follows = of_j < of_i;
                if (is_early ? precedes : follows) f(key(j), k);
            }
        };
        first.assign(keys + 1, 0);
        each([&](std::uint32_t to, std::uint32_t) { ++first[to + 1]; });
        for (std::size_t k = 0; k < keys; ++k) first[k + 1] += first[k];
        sorted.resize(first[keys]);
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        each([&](std::uint32_t to, std::uint32_t k) { sorted[next[to]++] = k; });
    };
    sort(
        true, ranges(), [&](std::uint32_t j) { return range_of_block[j / block]; }, early_start, early);
    sort(
        false, blocks, [&](std::uint32_t j) { return j / block; }, late_start, late);

    // also with a list that has no pairs now: the sweep rotates particles once there has been a history
    sum_j.resize(n), torque_j.resize(pairs.rotation_history.data() != nullptr ? n : 0);
    par::fill(par::Cpu(), sum_j.data(), sum_j.size(), Load{});
    par::fill(par::Cpu(), torque_j.data(), torque_j.size(), Float4{});
}

std::size_t SweepPlan::bytes() const
{
    std::size_t words = 0;
    for (const auto* v : {&first_block, &list, &early_start, &early, &late_start, &late, &marks_before})
        words += v->capacity();
    return words * sizeof(std::uint32_t) + marks.capacity() * sizeof(std::uint64_t) + sum_j.bytes() +
           torque_j.bytes();
}

}  // namespace hilda::granular
