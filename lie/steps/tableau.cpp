// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/tableau.hpp"

namespace hilda::lie {

void Tableau::interpolation(double s, std::vector<double>& out) const
{
    const int end = stages();
    for (int i = 0; i < all_stages(); ++i) {
        // The nested form, from the inside. Its factors alternate between s and 1 - s.
        double sum = 0;
        for (std::size_t k = dense.size(); k-- > 0;)
            sum = (k % 2 == 0 ? 1 - s : s) * (entry(dense[k], i) + sum);
        const double u_1 = entry(a[static_cast<std::size_t>(end)], i), u_2 = (i == 0 ? 1 : 0) - u_1,
                     u_3 = u_1 - (i == end ? 1 : 0) - u_2;
        out[static_cast<std::size_t>(i)] = s * (u_1 + (1 - s) * (u_2 + s * (u_3 + sum)));
    }
}

}  // namespace hilda::lie
