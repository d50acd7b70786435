// SPDX-License-Identifier: GPL-3.0-or-later
/// Functors that assign particles to cells and sort them by cell.

#pragma once

#include "granular/core/particles.hpp"

namespace hilda::granular::detail {

constexpr std::uint32_t outside_domain = ~std::uint32_t{0};  ///< key of a particle outside the domain

/// Assigns a particle to the cell in which it is, and computes its sort key: the number of the cell in the
/// order of replicas, z, y, x. For a particle that has left the domain all bits of the key are set, and its
/// position is not changed.
struct AssignCell {
    CellGrid grid;
    Position* position;
    const Species* species;
    std::uint32_t* key;
    std::uint32_t* order;
    /// Number of the clump by id, or no_clump; nullptr without clumps. A particle of a clump that is outside
    /// gets the closest cell: the clump leaves the domain with its centre of mass.
    const std::uint32_t* clump_of = nullptr;
    const std::uint32_t* id = nullptr;

    /// Moves a coordinate into the domain along a periodic axis, and finds its cell; false if it is outside
    /// the domain.
    HILDA_HD bool move(std::int32_t& cell, std::int32_t& x, int axis) const
    {
        const std::int32_t width = grid.width[axis], cells = grid.cells[axis];
        std::int32_t at = grid.local(x, cell, axis), steps = at / width;
        if (at < 0 && steps * width != at) --steps;  // round towards minus infinity
        at -= steps * width;
        cell += steps;
        if (grid.periodic[axis] != 0) {
            const std::int32_t turns = cell < 0 ? cells : cell >= cells ? -cells : 0;
            cell += turns, x = wrapped_sum(x, wrapped_product(turns, width));
            return true;
        }
        return cell >= 0 && (cell < cells - 1 || (cell == cells - 1 && at <= grid.last[axis]));
    }

    HILDA_HD std::int32_t nearest_cell(std::int32_t cell, int axis) const
    {
        const std::int32_t last = grid.cells[axis] - 1;
        return cell < 0 ? 0 : cell > last ? last : cell;
    }

    HILDA_HD void operator()(std::uint32_t k) const
    {
        Position p = position[k];
        std::int32_t x = grid.x_of(p.cell), y = grid.y_of(p.cell), z = grid.z_of(p.cell);
        const bool in_x = move(x, p.x, 0), in_y = move(y, p.y, 1), in_z = move(z, p.z, 2);
        order[k] = k;
        if (clump_of != nullptr && clump_of[id[k]] != no_clump) {
            x = nearest_cell(x, 0), y = nearest_cell(y, 1), z = nearest_cell(z, 2);
        } else if (!(in_x && in_y && in_z)) {
            key[k] = outside_domain;
            return;
        }
        p.cell = grid.pack(x, y, z);
        position[k] = p;
        key[k] = (species[k].replica * grid.cells[2] + z) * static_cast<std::uint32_t>(grid.cells[1]);
        key[k] = (key[k] + y) * static_cast<std::uint32_t>(grid.cells[0]) + x;
    }
};

/// Sorts the particles of each cell by their ids. One call per particle; that of the first particle of a cell
/// sorts all of the cell. Since the previous search only a few particles have changed their cell.
struct SortCells {
    const std::uint32_t *key, *id;
    std::uint32_t particles;
    std::uint32_t* order;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        if (k > 0 && key[k - 1] == key[k]) return;
        for (std::uint32_t a = k + 1; a < particles && key[a] == key[k]; ++a) {
            const std::uint32_t moved = order[a], its_id = id[moved];
            std::uint32_t b = a;
            for (; b > k && id[order[b - 1]] > its_id; --b) order[b] = order[b - 1];
            order[b] = moved;
        }
    }
};

/// The first particle of each cell. The numbers of cells have more values than there are particles if the
/// domain is almost empty; the table therefore has one entry for each group of 2^shift cells, and the search
/// within a group is a bisection.
struct CellStarts {
    const std::uint32_t *key, *start;
    int shift;

    /// Index of the first particle in this cell or a later one
    HILDA_HD std::uint32_t operator[](std::uint32_t cell) const
    {
        const std::uint32_t group = cell >> shift;
        std::uint32_t low = start[group];
        if (cell == group << shift) return low;
        return first_of(key, low, start[group + 1], cell);
    }
    /// Index of the first of the ascending keys from low to high - 1 that is at least `cell`; high if none is
    HILDA_HD static std::uint32_t first_of(const std::uint32_t* key, std::uint32_t low, std::uint32_t high,
                                           std::uint32_t cell)
    {
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            if (key[middle] < cell)
                low = middle + 1;
            else
                high = middle;
        }
        return low;
    }
};

/// start[g]: index of the first particle in group g or a later one, g = 0 … groups. One call per particle,
/// for sequential access on the CPU.
struct MarkCellStarts {
    const std::uint32_t* key;
    std::uint32_t particles, groups;
    int shift;
    std::uint32_t* start;

    HILDA_HD void operator()(std::uint32_t k) const  // k = 0 … particles
    {
        const std::uint32_t here = k < particles ? key[k] >> shift : groups;
        for (std::uint32_t g = k > 0 ? (key[k - 1] >> shift) + 1 : 0; g <= here; ++g) start[g] = k;
    }
};

/// The same as MarkCellStarts with one call per group, by bisection. On a GPU a thread then does not loop
/// over a long run of empty cells.
struct FindCellStart {
    const std::uint32_t* key;
    std::uint32_t particles;
    int shift;
    std::uint32_t* start;

    HILDA_HD void operator()(std::uint32_t g) const
    {
        start[g] = CellStarts::first_of(key, 0, particles, g << shift);
    }
};

/// Index after sorting of each particle before sorting
struct Invert {
    const std::uint32_t* order;
    std::uint32_t* new_index;
    HILDA_HD void operator()(std::uint32_t k) const { new_index[order[k]] = k; }
};

}  // namespace hilda::granular::detail
