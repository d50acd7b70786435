// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/minimum_degree.hpp"

#include <amd.h>

#include <new>

namespace hilda::lie {

std::vector<int> minimum_degree_order(const std::vector<std::set<int>>& neighbours)
{
    std::vector<int> start{0}, index, order(neighbours.size());
    index.reserve(1), order.reserve(1);  // AMD rejects null pointers
    for (const std::set<int>& of : neighbours) {
        index.insert(index.end(), of.begin(), of.end());
        start.push_back(static_cast<int>(index.size()));
    }
    if (amd_order(static_cast<int>(order.size()), start.data(), index.data(), order.data(), nullptr,
                  nullptr) < AMD_OK)
        throw std::bad_alloc();  // the only error for a pattern that is valid
    return order;
}

}  // namespace hilda::lie
