// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/newton_matrix.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hilda::lie {

template <class Scalar>
int BasicNewtonMatrix<Scalar>::declare(int first_row, int first_column, int rows, int columns)
{
    const int handle = static_cast<int>(row.size());
    for (int c = 0; c < columns; ++c)
        for (int r = 0; r < rows; ++r) {
            row.push_back(first_row + r);
            column.push_back(first_column + c);
        }
    return handle;
}

template <class Scalar>
void BasicNewtonMatrix<Scalar>::analyse(int n, std::vector<int> order_of_pivots)
{
    for (int k = 0; k < n; ++k) declare(k, k, 1, 1);
    std::vector<int> order(row.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return std::pair(column[a], row[a]) < std::pair(column[b], row[b]); });

    slot.resize(row.size());
    std::vector<int> column_start(n + 1, 0), row_index;
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
    klu.analyse(std::move(column_start), std::move(row_index), std::move(order_of_pivots));
}

template <class Scalar>
void BasicNewtonMatrix<Scalar>::factor()
{
    if (!klu.refactor()) klu.factor("the Newton matrix");
}

template <class Scalar>
void BasicNewtonMatrix<Scalar>::factor_in_order()
{
    klu.factor_in_order("the Newton matrix");
}

template <class Scalar>
void BasicNewtonMatrix<Scalar>::solve(Vector& b) const
{
    klu.solve(b.data());
    if (!std::isfinite(std::abs(b.sum()))) throw NonFinite("the solution of the Newton system is not finite");
}

template class BasicNewtonMatrix<double>;
template class BasicNewtonMatrix<std::complex<double>>;

}  // namespace hilda::lie
