// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/block_entries.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace hilda::lie {

int BlockEntries::declare(int first_row, int first_column, int rows, int columns)
{
    const int handle = static_cast<int>(row.size());
    for (int c = 0; c < columns; ++c)
        for (int r = 0; r < rows; ++r) {
            row.push_back(first_row + r);
            column.push_back(first_column + c);
        }
    return handle;
}

void BlockEntries::analyse(int n, std::vector<int>& column_start, std::vector<int>& row_index)
{
    for (int k = 0; k < n; ++k) declare(k, k, 1, 1);
    std::vector<int> order(row.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return std::pair(column[a], row[a]) < std::pair(column[b], row[b]); });

    slot.resize(row.size());
    column_start.assign(static_cast<size_t>(n) + 1, 0);
    row_index.clear();
    int last = -1;
    for (const int k : order) {
        if (last < 0 || column[last] != column[k] || row[last] != row[k]) {
            row_index.push_back(row[k]);
            ++column_start[column[k] + 1];
        }
        slot[k] = static_cast<int>(row_index.size()) - 1;
        last = k;
    }
    std::partial_sum(column_start.begin(), column_start.end(), column_start.begin());
}

}  // namespace hilda::lie
