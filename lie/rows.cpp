// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/rows.hpp"

#include <algorithm>

namespace hilda::lie {

void Rows::regularise(std::span<const double> compliances)
{
    compliance.assign(compliances.begin(), compliances.end());
    if (!compliances.empty()) return;
    compliance.resize(regularised.size(), 0);
    for (const int k : regularised)
        for (int n = start[k]; n < start[k + 1]; ++n) entry[n].r.setZero(), entry[n].pi.setZero();
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
