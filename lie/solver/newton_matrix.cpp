// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/newton_matrix.hpp"

#include "lie/check.hpp"

#include <cmath>
#include <utility>

namespace hilda::lie {

void NewtonMatrix::analyse(int n)
{
    std::vector<int> column_start, row_index;
    entries.analyse(n, column_start, row_index);
    klu.analyse(std::move(column_start), std::move(row_index));
}

void NewtonMatrix::factor()
{
    if (!klu.refactor()) klu.factor("the Newton matrix");
}

void NewtonMatrix::solve(Eigen::VectorXd& b) const
{
    klu.solve(b.data());
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the Newton system is not finite");
}

}  // namespace hilda::lie
