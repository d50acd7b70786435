// SPDX-License-Identifier: GPL-3.0-or-later
/// A sparse Newton matrix, assembled from small dense blocks and factored by KLU. The blocks are declared and
/// analysed once. For each factorisation their values are added.
///
///     const int at = N.declare(row, column, 6, 6);      // overlapping blocks are summed
///     N.analyse(n);                                     // n unknowns
///     N.set_zero();  N.add(at, 0.5 * h * B);  N.factor();  N.solve(b);

#pragma once

#include "lie/solver/block_entries.hpp"
#include "lie/solver/klu.hpp"

#include <Eigen/Core>

#include <algorithm>

namespace hilda::lie {

class NewtonMatrix {
public:
    /// Declares the rows × columns block with the first entry (row, column). Returns its handle for add().
    int declare(int row, int column, int rows, int columns)
    {
        return entries.declare(row, column, rows, columns);
    }
    /// Analyses the pattern of the n × n matrix. All diagonal entries are part of it.
    void analyse(int n);

    void set_zero() { std::fill(klu.value.begin(), klu.value.end(), 0.); }
    template <class Block>
    void add(int handle, const Eigen::MatrixBase<Block>& block)
    {
        entries.add(handle, block, klu.value.data());
    }
    void add(int handle, double entry) { klu.value[entries.at(handle)] += entry; }
    /// Multiplies rows and columns by these factors, after all values have been added.
    void scale(const Eigen::VectorXd& rows, const Eigen::VectorXd& columns)
    {
        for (int column = 0; column < klu.size(); ++column)
            for (int k = klu.columns()[column]; k < klu.columns()[column + 1]; ++k)
                klu.value[k] *= rows[klu.rows()[k]] * columns[column];
    }

    /// Reuses pivots as long as they are accurate (Klu::refactor). Throws SingularMatrix, NonFinite.
    void factor();
    /// Solves in place. Throws NonFinite if the solution is not finite.
    void solve(Eigen::VectorXd& b) const;

    /// The matrix in compressed columns, for another solver
    const Klu& compressed() const { return klu; }
    long factorizations() const { return klu.factorizations(); }
    long refactorizations() const { return klu.refactorizations(); }
    double reciprocal_condition() const { return klu.reciprocal_condition(); }

private:
    BlockEntries entries;
    Klu klu{Klu::Scaling::rows};
};

}  // namespace hilda::lie
