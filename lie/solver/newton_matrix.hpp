// SPDX-License-Identifier: GPL-3.0-or-later
/// A Newton matrix put together from small dense blocks: declare the blocks, analyse once, then add values and
/// factor as often as needed.
///
///     const int at = N.declare(row, column, 6, 6);      // blocks may overlap: values add up
///     N.analyse();
///     N.set_zero();  N.add(at, 0.5 * h * B);  N.factor();  N.solve(b);

#pragma once

#include "lie/solver/klu.hpp"

#include <Eigen/Core>

namespace hilda::lie {

class NewtonMatrix {
public:
    /// Returns a handle of the block whose first entry is (row, column).
    int declare(int row, int column, int rows, int columns);
    /// `n` unknowns; every entry of the diagonal is declared by the way.
    void analyse(int n);

    void set_zero() { std::fill(klu.value.begin(), klu.value.end(), 0.0); }
    template <class Block>
    void add(int handle, const Eigen::MatrixBase<Block>& block)
    {
        const int* s = slot.data() + handle;
        for (Eigen::Index c = 0; c < block.cols(); ++c)
            for (Eigen::Index r = 0; r < block.rows(); ++r) klu.value[*s++] += block(r, c);
    }
    void add(int handle, double entry) { klu.value[slot[handle]] += entry; }

    /// Keeps pivots while they serve. Throws SingularMatrix, NonFinite.
    void factor();
    /// In place. Throws NonFinite when the solution is not finite.
    void solve(Eigen::VectorXd& b) const;

    /// Compressed columns and their values, for whoever solves elsewhere
    const Klu& compressed() const { return klu; }
    long factorizations() const { return klu.factorizations(); }
    long refactorizations() const { return klu.refactorizations(); }

private:
    Klu klu{Klu::Scaling::rows};
    std::vector<int> row, column;  ///< of each declared entry
    std::vector<int> slot;         ///< where it stands in klu.value
};

}  // namespace hilda::lie
