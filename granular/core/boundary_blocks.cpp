// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/boundary_blocks.hpp"

#include "granular/core/surfaces/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hilda::granular {

namespace {

// A block has a few triangles or more, so that the blocks need less memory than the triangles.
constexpr std::int64_t least_blocks = 1 << 15, blocks_per_triangle = 1;

bool same_cells(const CellGrid& a, const CellGrid& b)
{
    return std::equal(a.low, a.low + 3, b.low) && a.unit == b.unit &&
           std::equal(a.cells, a.cells + 3, b.cells) && std::equal(a.width, a.width + 3, b.width);
}

}  // namespace

bool BoundaryBlocks::update(const CellGrid& grid, double reach, const std::vector<Boundary>& boundaries,
                            const Meshes& meshes)
{
    const bool anew = surfaces.size() != boundaries.size() || reach != reach_of || !same_cells(grid, of);
    if (surfaces.size() != boundaries.size()) moves.assign(boundaries.size(), false);
    bool rests_changed = anew, moves_changed = anew;
    for (std::size_t b = 0; b < surfaces.size() && b < boundaries.size(); ++b) {
        if (surfaces[b] == surface_of(boundaries[b])) continue;
        moves_changed = true;
        if (!moves[b]) moves[b] = true, rests_changed = true;
    }
    if (!moves_changed) return false;
    of = grid, reach_of = reach;
    surfaces.clear();
    for (const Boundary& b : boundaries) surfaces.push_back(surface_of(b));
    std::vector<bool> rests = moves;
    rests.flip();
    if (rests_changed) resting.fill(grid, reach, boundaries, meshes, rests);
    moving.fill(grid, reach, boundaries, meshes, moves);
    return true;
}

/// Sets the number of blocks: cells if there are few, else as many cells per block as necessary.
void SurfaceLists::make_blocks(std::int64_t most)
{
    for (shift = 0;; ++shift) {
        std::int64_t all = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            blocks[k] = (of.cells[k] + (1 << shift) - 1) >> shift;
            all *= blocks[k];
        }
        if (all <= most) return;
    }
}

void SurfaceLists::fill(const CellGrid& grid, double reach, const std::vector<Boundary>& boundaries,
                        const Meshes& meshes, const std::vector<bool>& which)
{
    of = grid, reach_of = reach;
    std::int64_t triangles = 0;
    for (const Meshes::Part& part : meshes.part)
        if (which[part.boundary]) triangles += part.end - part.first;
    const bool any = std::find(which.begin(), which.end(), true) != which.end();
    make_blocks(any ? std::max(least_blocks, blocks_per_triangle * triangles) : 1);

    std::vector<Near> found;  // in ascending order of the surfaces: those with triangles are the last ones
    for (std::size_t b = 0; b < boundaries.size(); ++b)
        if (which[b] && boundaries[b].shape != Boundary::Shape::mesh)
            search(boundaries[b], {{0, 0, 0}, blocks}, static_cast<std::uint32_t>(b), found);
    for (const Meshes::Part& part : meshes.part)
        for (std::uint32_t t = part.first; which[part.boundary] && t < part.end; ++t)
            search_triangle(boundaries[part.boundary], meshes, t, found);

    start.assign(static_cast<std::size_t>(blocks[0]) * blocks[1] * blocks[2] + 1, 0);
    for (const Near& n : found) ++start[n.block];
    std::partial_sum(start.begin(), start.end(), start.begin());
    surface.resize(start.back());
    // from the last one on, so that the ends of the blocks become their starts
    for (auto n = found.rbegin(); n != found.rend(); ++n) surface[--start[n->block]] = n->surface;
}

/// Adds the blocks that are near the triangle t of a mesh.
void SurfaceLists::search_triangle(const Boundary& b, const Meshes& meshes, std::uint32_t t,
                                   std::vector<Near>& found) const
{
    const MeshTriangle& T = meshes.triangle[t];
    BoundingBox box;
    for (const std::uint32_t v : T.vertex) box.add(b.r + rotated(b.p, meshes.vertex[v]));
    const Vec3 n = rotated(b.p, T.face.n), a = b.r + rotated(b.p, meshes.vertex[T.vertex[0]]);
    const double lows[] = {box.low.x, box.low.y, box.low.z}, highs[] = {box.high.x, box.high.y, box.high.z};
    std::int32_t first[3], last[3];
    double size[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const double width = of.width[k] * of.unit, margin = reach_of + 0.01 * width;
        size[k] = width * (1 << shift);
        const auto block = [&](double x) {
            return static_cast<std::int32_t>(std::clamp(std::floor((x - of.low[k]) / size[k]), -1., 1e9));
        };
        first[k] = std::max(block(lows[k] - margin), 0);
        last[k] = std::min(block(highs[k] + margin), blocks[k] - 1);
    }
    const double across = 0.5 * (std::abs(n.x) * size[0] + std::abs(n.y) * size[1] + std::abs(n.z) * size[2]);
    const double most = across + reach_of + 0.01 * std::max({size[0], size[1], size[2]});
    for (std::int32_t z = first[2]; z <= last[2]; ++z)
        for (std::int32_t y = first[1]; y <= last[1]; ++y)
            for (std::int32_t x = first[0]; x <= last[0]; ++x) {
                const Vec3 centre{of.low[0] + (x + 0.5) * size[0], of.low[1] + (y + 0.5) * size[1],
                                  of.low[2] + (z + 0.5) * size[2]};
                if (std::abs((centre - a).dot(n)) > most) continue;
                found.push_back({static_cast<std::uint32_t>((z * blocks[1] + y) * blocks[0] + x),
                                 Surfaces::first_triangle + t});
            }
}

/// Adds the blocks of a box that are near the boundary.
void SurfaceLists::search(const Boundary& b, const Box& box, std::uint32_t number,
                          std::vector<Near>& found) const
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
    if (distance_bound(b, centre) - std::sqrt(half_diagonal2) > reach_of) return;
    const std::int32_t first = box.first[longest], last = box.last[longest];
    if (last - first == 1) {
        const std::int32_t row = box.first[2] * blocks[1] + box.first[1];
        found.push_back({static_cast<std::uint32_t>(row * blocks[0] + box.first[0]), number});
        return;
    }
    Box part = box;
    part.last[longest] = first + (last - first) / 2;
    search(b, part, number, found);
    part = box;
    part.first[longest] = first + (last - first) / 2;
    search(b, part, number, found);
}

}  // namespace hilda::granular
