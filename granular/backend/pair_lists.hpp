// SPDX-License-Identifier: GPL-3.0-or-later
/// Lists of the pairs that fulfil a condition, in their order.

#pragma once

#include "granular/backend/par.hpp"

namespace hilda::granular::detail {

/// Counts the pairs of a block that fulfil a condition, and writes their numbers in their order.
template <class Condition>
struct ListPairs {
    static constexpr std::uint32_t block = 64;

    Condition is_listed;
    std::uint32_t pairs;
    std::uint32_t* count;         ///< of the pairs of each block
    const std::uint32_t* before;  ///< number of listed pairs before each block
    std::uint32_t* list;          ///< nullptr: the pairs are only counted

    HILDA_HD void operator()(std::uint32_t number) const
    {
        const std::uint32_t begin = number * block, end = pairs - begin < block ? pairs : begin + block;
        std::uint32_t listed = 0;
        for (std::uint32_t n = begin; n < end; ++n) {
            if (!is_listed(n)) continue;
            if (list != nullptr) list[before[number] + listed] = n;
            ++listed;
        }
        if (list == nullptr) count[number] = listed;
    }
};

template <class Backend>
class PairLister {
public:
    /// Writes the numbers of those of the first n pairs that fulfil a condition to `list`, in their order.
    /// Returns how many there are.
    template <class Condition>
    std::uint32_t list_pairs(const Backend& on, const Condition& condition, std::uint32_t n,
                             par::Array<Backend, std::uint32_t>& list)
    {
        using List = ListPairs<Condition>;
        const std::uint32_t blocks = (n + List::block - 1) / List::block;
        counts.resize(2 * std::size_t{blocks} + 1);
        std::uint32_t *const count = counts.data(), *const before = count + blocks;
        par::for_each(on, blocks, List{condition, n, count, before, nullptr});
        const auto listed = static_cast<std::uint32_t>(par::exclusive_scan(on, count, before, blocks));
        list.resize(listed);
        if (listed > 0) par::for_each(on, blocks, List{condition, n, count, before, list.data()});
        return listed;
    }

    std::size_t bytes() const { return counts.bytes(); }

private:
    par::Array<Backend, std::uint32_t> counts;
};

}  // namespace hilda::granular::detail
