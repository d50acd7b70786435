// SPDX-License-Identifier: GPL-3.0-or-later
/// The division of the domain among processes: blocks of cells with weights, and recursive coordinate
/// bisection by Zoltan.

#pragma once

#include "granular/core/particles.hpp"
#include "granular/distributed/communicator.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

struct Zoltan_Struct;

namespace hilda::granular {

/// Cubes of cells; the last ones along an axis may have fewer cells.
struct BlockGrid {
    std::int32_t shift = 0;              ///< a block has 2^shift cells along an edge
    std::int32_t blocks[3] = {1, 1, 1};  ///< number of blocks along each axis

    BlockGrid() = default;
    BlockGrid(const CellGrid& grid, std::int32_t shift) : shift(shift)
    {
        for (int k = 0; k < 3; ++k) blocks[k] = ((grid.cells[k] - 1) >> shift) + 1;
    }
    /// Number of the block with these numbers along the axes
    std::uint32_t number(std::int32_t x, std::int32_t y, std::int32_t z) const
    {
        return static_cast<std::uint32_t>((z * blocks[1] + y) * blocks[0] + x);
    }
    /// Number of the block of a cell
    std::uint32_t block_of(std::int32_t x, std::int32_t y, std::int32_t z) const
    {
        return number(x >> shift, y >> shift, z >> shift);
    }
    double count() const { return double(blocks[0]) * blocks[1] * blocks[2]; }
};

/// The work of a block
struct BlockWork {
    std::uint32_t block;
    float weight;
};

class Partition {
public:
    static constexpr std::int32_t shifts[] = {3, 2, 1};  ///< see BlockGrid

    explicit Partition(const Communicator& all);
    ~Partition();
    Partition(const Partition&) = delete;
    Partition& operator=(const Partition&) = delete;

    /// Distributes the blocks. `work`: blocks and weights of this process; each block is that of one process
    /// only.
    void make(const CellGrid& cells, std::int32_t shift, const std::vector<BlockWork>& work);
    const BlockGrid& grid() const { return blocks; }
    /// Whether the domain with these cells has been divided
    bool is_for(const CellGrid& cells) const
    {
        return is_cut && std::equal(cells.cells, cells.cells + 3, of_cells);
    }

    /// The process that has a block
    int owner(std::uint32_t block) const
    {
        int& known = owners[block];
        return known >= 0 ? known : known = found_owner(block);
    }

private:
    struct Objects;
    int found_owner(std::uint32_t block) const;
    void place(std::uint32_t block, double* x) const;

    const Communicator& all;
    Zoltan_Struct* zoltan;
    BlockGrid blocks;
    std::int32_t of_cells[3] = {0, 0, 0};  ///< number of cells along each axis
    bool is_cut = false;                   ///< whether Zoltan has cut the domain; there were blocks with work
    mutable std::vector<int> owners;       ///< -1: not known yet
};

}  // namespace hilda::granular
