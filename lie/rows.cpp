// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/rows.hpp"

#include <algorithm>

namespace hilda::lie {

void Rows::regularise(std::span<const double> compliances)
{
    compliance.resize(regularised.size(), 0);
    std::copy(compliances.begin(), compliances.end(), compliance.begin());
    if (!compliances.empty()) return;
    for (size_t r = 0; r + springs < regularised.size(); ++r) {
        compliance[r] = 0;
        clear(regularised[r]);
    }
}

void Rows::append_springs(const Rows& pattern)
{
    const int offset = start.back();
    for (int k = 0; k < pattern.rows(); ++k) {
        regularised.push_back(rows());
        start.push_back(offset + pattern.start[k + 1]);
    }
    entry.insert(entry.end(), pattern.entry.begin(), pattern.entry.end());
    velocity_rows += pattern.rows();
    springs += pattern.rows();
    compliance.resize(regularised.size(), 0);
}

void Rows::set_springs(const Rows& values, std::span<const double> compliances)
{
    std::copy(values.entry.begin(), values.entry.end(),
              entry.end() - static_cast<std::ptrdiff_t>(values.entry.size()));
    compliance.resize(regularised.size(), 0);
    std::copy(compliances.begin(), compliances.end(),
              compliance.end() - static_cast<std::ptrdiff_t>(compliances.size()));
}

bool Rows::is_regularised(int k) const
{
    return std::binary_search(regularised.begin(), regularised.end(), k);
}

bool Rows::is_inactive(int k) const
{
    for (int n = start[k]; n < start[k + 1]; ++n)
        if (entry[n].r != Vec3::Zero() || entry[n].pi != Vec3::Zero()) return false;
    const auto group =
        std::lower_bound(algebraic.begin(), algebraic.end(), k,
                         [](const AlgebraicGroup& m, int row) { return m.first + m.rows - 1 < row; });
    return group == algebraic.end() || group->first + group->rows - 1 != k ||
           group->D.bottomRows<1>().isZero(0);
}

SecondVariation::SecondVariation(const Rows& pattern)
{
    for (int k = 0; k < pattern.rows(); ++k) {
        first.push_back(static_cast<int>(block.size()));
        entries.push_back(pattern.start[k + 1] - pattern.start[k]);
        block.resize(block.size() + entries[k] * entries[k], Mat6::Zero());
    }
}

}  // namespace hilda::lie
