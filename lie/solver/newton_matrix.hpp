// SPDX-License-Identifier: GPL-3.0-or-later
/// A sparse Newton matrix, assembled from small dense blocks. The blocks are declared and analysed once. For
/// each factorisation their values are added.
///
///     const int at = N.declare(row, column, 6, 6);      // overlapping blocks are summed
///     N.analyse(n);                                     // n unknowns
///     N.set_zero();  N.add(at, 0.5 * h * B);  N.factor();  N.solve(b);

#pragma once

#include "lie/solver/klu.hpp"

#include <Eigen/Core>

namespace hilda::lie {

/// Scalar is double or std::complex<double>.
template <class Scalar>
class BasicNewtonMatrix {
public:
    /// Declares the rows × columns block with the first entry (row, column). Returns its handle for add().
    int declare(int row, int column, int rows, int columns);
    /// Analyses the pattern of the n × n matrix. All diagonal entries are part of it.
    /// With an `order`, the pivots are the diagonal entries in this order: use factor_in_order().
    void analyse(int n, std::vector<int> order = {});

    void set_zero() { std::fill(klu.value.begin(), klu.value.end(), Scalar(0)); }
    template <class Block>
    void add(int handle, const Eigen::MatrixBase<Block>& block)
    {
        const int* s = slot.data() + handle;
        for (Eigen::Index c = 0; c < block.cols(); ++c)
            for (Eigen::Index r = 0; r < block.rows(); ++r) klu.value[*s++] += block(r, c);
    }
    void add(int handle, Scalar entry) { klu.value[slot[handle]] += entry; }

    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

    /// Reuses pivots as long as they are accurate (Klu::refactor). Throws SingularMatrix, NonFinite.
    void factor();
    /// Klu::factor_in_order
    void factor_in_order();
    /// Solves in place. Throws NonFinite if the solution is not finite.
    void solve(Vector& b) const;

    /// The matrix in compressed columns, for another solver
    const BasicKlu<Scalar>& compressed() const { return klu; }
    long factorizations() const { return klu.factorizations(); }
    long refactorizations() const { return klu.refactorizations(); }
    double reciprocal_condition() const { return klu.reciprocal_condition(); }

private:
    BasicKlu<Scalar> klu{BasicKlu<Scalar>::Scaling::rows};
    std::vector<int> row, column;  ///< of each declared entry
    std::vector<int> slot;         ///< its index in klu.value
};

extern template class BasicNewtonMatrix<double>;
extern template class BasicNewtonMatrix<std::complex<double>>;

using NewtonMatrix = BasicNewtonMatrix<double>;

}  // namespace hilda::lie
