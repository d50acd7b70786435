// SPDX-License-Identifier: GPL-3.0-or-later
/// LU factorisation of a sparse matrix with diagonal pivots in a given order, by dense fronts (multifrontal
/// method; Duff, Reid 1983).
///
/// The pattern is that of A and Aᵀ together. Consecutive pivots whose columns have nearly the same entries
/// below them are eliminated together, in a dense matrix of their rows and columns (the front):
///
///     | F_pp  F_pb |      F_pp: the pivots;  F_pb, F_bp: their entries at later unknowns (the border)
///     | F_bp  S    |      S: after the elimination, F_bb - F_bp F_pp⁻¹ F_pb, which is added to the front of
///                            the first unknown of the border
///
/// For a mechanism, the pivots of a front are the six unknowns of a body and the rows behind it. The fronts
/// are stored by columns of four numbers. All operations of an elimination are multiplications of such
/// columns by a number, without indices.
///
///     const int at = N.declare(row, column, 6, 6);      // overlapping blocks are summed
///     N.analyse(n, order);                              // n unknowns
///     N.set_zero();  N.add(at, 0.5 * h * B);  N.factor();  N.solve(b);

#pragma once

#include "lie/solver/block_entries.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace hilda::lie {

/// Scalar is double or std::complex<double>.
template <class Scalar>
class MultifrontalLu {
public:
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

    /// Declares the rows × columns block with the first entry (row, column). Returns its handle for add().
    int declare(int row, int column, int rows, int columns)
    {
        return entries.declare(row, column, rows, columns);
    }
    /// Analyses the pattern of the n × n matrix. The pivots are the diagonal entries order[0], order[1], …
    void analyse(int n, const std::vector<int>& order);

    void set_zero() { std::fill(value.begin(), value.end(), Scalar(0)); }
    template <class Block>
    void add(int handle, const Eigen::MatrixBase<Block>& block)
    {
        entries.add(handle, block, value.data());
    }
    void add(int handle, Scalar entry) { value[static_cast<size_t>(entries.at(handle))] += entry; }

    /// The factors depend on the present values only. Throws SingularMatrix if a pivot is zero, and NonFinite
    /// for values that are not finite.
    void factor();
    /// Solves in place; b has n components. Throws NonFinite if the solution is not finite.
    void solve(Vector& b);

    long factorizations() const { return count; }
    /// Smallest ratio of a pivot to the largest entry of its row in the matrix, divided by the largest such
    /// ratio
    double reciprocal_condition() const;

private:
    static constexpr int height = 4;  ///< of a column of numbers
    using Column = Eigen::Array<double, height, 1>;
    static constexpr int scalars = height * sizeof(double) / sizeof(Scalar);  ///< in a column of numbers

    struct Front {
        int first = 0, pivots = 0;  ///< its pivots, in the order of elimination
        int size = 0;               ///< pivots and border
        int columns = 0;            ///< columns of four numbers in a column of the front
        size_t at = 0;              ///< first one in `number`
        int parent = -1;            ///< the front to which S is added
        int unknown = 0;            ///< first index in `unknown_of` of its unknowns
    };
    Scalar* numbers(const Front& f) { return reinterpret_cast<Scalar*>(number.data() + f.at); }
    const Scalar* numbers(const Front& f) const
    {
        return reinterpret_cast<const Scalar*>(number.data() + f.at);
    }
    /// Returns the front of each pivot. `below`: the unknowns below each pivot
    std::vector<int> find_fronts(const std::vector<std::vector<int>>& below);
    void eliminate(const Front& f);
    void eliminate_one(const Front& f, int k);
    void eliminate_four(const Front& f, int k);
    void add_to_parent(const Front& f);

    BlockEntries entries;
    std::vector<Scalar> value;
    std::vector<int> row_of;        ///< of each value
    std::vector<size_t> scalar_at;  ///< the index of each value among all scalars of the fronts
    std::vector<int> place;         ///< of each unknown in the order of elimination
    std::vector<Front> front;
    std::vector<int> unknown_of;       ///< by front: places, ascending
    std::vector<int> index_in_parent;  ///< by front: of its unknowns; -1 for the pivots
    std::vector<Column> number;        ///< the fronts
    std::vector<Column> l, i_l;        ///< four columns of L, and i times one column
    std::vector<Scalar> pivot, inverse;
    Vector b_ordered, part;  ///< workspace of solve()
    long count = 0;
};

extern template class MultifrontalLu<double>;
extern template class MultifrontalLu<std::complex<double>>;

}  // namespace hilda::lie
