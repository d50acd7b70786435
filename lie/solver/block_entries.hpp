// SPDX-License-Identifier: GPL-3.0-or-later
/// The entries of a sparse matrix that is the sum of small dense blocks. The blocks are declared and analysed
/// once. Their values are added to the array of the entries.

#pragma once

#include <Eigen/Core>

#include <vector>

namespace hilda::lie {

class BlockEntries {
public:
    /// Declares the rows × columns block with the first entry (row, column). Returns its handle for add().
    int declare(int row, int column, int rows, int columns);
    /// Sets the pattern of the n × n matrix in compressed columns, rows ascending. All diagonal entries are
    /// part of it.
    void analyse(int n, std::vector<int>& column_start, std::vector<int>& row_index);

    /// Adds a block to the entries `value`, which are in the order of row_index.
    template <class Block, class Scalar>
    void add(int handle, const Eigen::MatrixBase<Block>& block, Scalar* value) const
    {
        const int* s = slot.data() + handle;
        for (Eigen::Index c = 0; c < block.cols(); ++c)
            for (Eigen::Index r = 0; r < block.rows(); ++r) value[*s++] += block(r, c);
    }
    /// Index in `value` of the first entry of the block
    int at(int handle) const { return slot[static_cast<size_t>(handle)]; }

private:
    std::vector<int> row, column;  ///< of each declared entry
    std::vector<int> slot;         ///< its index in `value`
};

}  // namespace hilda::lie
