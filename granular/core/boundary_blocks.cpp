// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/boundary_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hilda::granular {

namespace {

constexpr std::int64_t most_blocks = 1 << 15;

bool same_cells(const CellGrid& a, const CellGrid& b)
{
    return std::equal(a.low, a.low + 3, b.low) && a.unit == b.unit &&
           std::equal(a.cells, a.cells + 3, b.cells) && std::equal(a.width, a.width + 3, b.width);
}

}  // namespace

/// Sets the number of blocks: cells if there are few, else as many cells per block as necessary.
void BoundaryBlocks::make_blocks(const CellGrid& grid)
{
    of = grid;
    for (shift = 0;; ++shift) {
        std::int64_t all = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            blocks[k] = (grid.cells[k] + (1 << shift) - 1) >> shift;
            all *= blocks[k];
        }
        if (all <= most_blocks) return;
    }
}

bool BoundaryBlocks::update(const CellGrid& grid, double reach, const std::vector<Boundary>& boundaries)
{
    bool changed = surfaces.size() != boundaries.size();
    if (reach != reach_of || !same_cells(grid, of)) {
        make_blocks(grid);
        reach_of = reach;
        surfaces.clear();
        changed = true;
    }
    near.resize(boundaries.size());
    for (std::size_t b = 0; b < boundaries.size(); ++b) {
        const Surface now = surface(boundaries[b]);
        if (b < surfaces.size() && surfaces[b] == now) continue;
        near[b].clear();
        search(boundaries[b], {{0, 0, 0}, blocks}, near[b]);
        changed = true;
    }
    if (!changed) return false;
    surfaces.clear();
    for (const Boundary& b : boundaries) surfaces.push_back(surface(b));

    const std::size_t count = static_cast<std::size_t>(blocks[0]) * blocks[1] * blocks[2];
    start.assign(count + 1, 0);
    for (const auto& of_boundary : near)
        for (const std::uint32_t block : of_boundary) ++start[block + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    boundary.resize(start.back());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (std::uint32_t b = 0; b < near.size(); ++b)
        for (const std::uint32_t block : near[b]) boundary[next[block]++] = b;
    return true;
}

/// Adds the blocks of a box that are near the boundary.
void BoundaryBlocks::search(const Boundary& b, const Box& box, std::vector<std::uint32_t>& found) const
{
    // A hundredth of a cell on each side allows for rounding.
    Vec3 centre{0, 0, 0};
    double* const at[] = {&centre.x, &centre.y, &centre.z};
    double half_diagonal2 = 0;
    std::size_t longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double width = of.width[k] * of.unit, block = width * (1 << shift);
        *at[k] = of.low[k] + 0.5 * block * (box.first[k] + box.last[k]);
        const double half = 0.5 * block * (box.last[k] - box.first[k]) + 0.01 * width;
        half_diagonal2 += half * half;
        if (box.last[k] - box.first[k] > box.last[longest] - box.first[longest]) longest = k;
    }
    if (nearest(b, centre).distance - std::sqrt(half_diagonal2) > reach_of) return;
    const std::int32_t first = box.first[longest], last = box.last[longest];
    if (last - first == 1) {
        const std::int32_t row = box.first[2] * blocks[1] + box.first[1];
        found.push_back(static_cast<std::uint32_t>(row * blocks[0] + box.first[0]));
        return;
    }
    Box part = box;
    part.last[longest] = first + (last - first) / 2;
    search(b, part, found);
    part = box;
    part.first[longest] = first + (last - first) / 2;
    search(b, part, found);
}

std::size_t BoundaryBlocks::bytes() const
{
    std::size_t words = start.capacity() + boundary.capacity();
    for (const auto& of_boundary : near) words += of_boundary.capacity();
    return words * sizeof(std::uint32_t) + surfaces.capacity() * sizeof(Surface);
}

}  // namespace hilda::granular
