// SPDX-License-Identifier: GPL-3.0-or-later
/// The surfaces near each block of cells, so that a neighbour search does not test all of them for each
/// particle.

#pragma once

#include "granular/core/particles.hpp"
#include "granular/core/surfaces/meshes.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hilda::granular {

/// Blocks of cells and the surfaces near them, for the functors. Those of block b have the numbers
/// surface[start[b]] … surface[start[b + 1] - 1], in ascending order; see Surfaces.
struct SurfaceListView {
    const std::uint32_t *start = nullptr, *surface = nullptr;
    std::int32_t shift = 0;                   ///< a block has 2^shift cells along each axis
    std::int32_t blocks_x = 0, blocks_y = 0;  ///< number of blocks along x and y

    HILDA_HD std::uint32_t block(std::int32_t x, std::int32_t y, std::int32_t z) const
    {
        const std::int32_t row = (z >> shift) * blocks_y + (y >> shift);
        return static_cast<std::uint32_t>(row * blocks_x + (x >> shift));
    }
};

/// The surfaces near a cell
struct BoundaryBlockView {
    SurfaceListView resting, moving;

    /// Calls f(surface) for those near the cell (x, y, z), in ascending order.
    template <class F>
    HILDA_HD void each(std::int32_t x, std::int32_t y, std::int32_t z, const F& f) const
    {
        const std::uint32_t r = resting.block(x, y, z), m = moving.block(x, y, z);
        std::uint32_t a = resting.start[r], b = moving.start[m];
        const std::uint32_t end_a = resting.start[r + 1], end_b = moving.start[m + 1];
        while (a < end_a || b < end_b) {
            const bool is_resting = b == end_b || (a < end_a && resting.surface[a] < moving.surface[b]);
            f(is_resting ? resting.surface[a++] : moving.surface[b++]);
        }
    }
};

/// Blocks of cells with the surfaces of some boundaries that are within the reach of a particle in one of
/// their cells.
///
/// The boxes of the blocks are halved repeatedly. A boundary is not near a box if its distance from the
/// centre, less half of the diagonal, is above the reach: distance_bound() changes by at most 1 m per m.
/// Points behind a boundary have a negative distance, so that it is listed there. A triangle is near the
/// blocks that its box and its plane meet, both enlarged by the reach.
class SurfaceLists {
public:
    /// Lists the boundaries b with which[b]. `reach`: largest radius and skin [m].
    void fill(const CellGrid& grid, double reach, const std::vector<Boundary>& boundaries,
              const Meshes& meshes, const std::vector<bool>& which);

    /// With pointers to `start` and `surface`
    SurfaceListView view() const { return {start.data(), surface.data(), shift, blocks[0], blocks[1]}; }

    std::vector<std::uint32_t> start, surface;  ///< see SurfaceListView

    std::size_t bytes() const { return (start.capacity() + surface.capacity()) * sizeof(std::uint32_t); }

private:
    struct Box {
        std::array<std::int32_t, 3> first, last;  ///< blocks, `last` excluded
    };
    struct Near {
        std::uint32_t block, surface;
    };
    void make_blocks(std::int64_t most);
    void search(const Boundary& b, const Box& box, std::uint32_t number, std::vector<Near>& found) const;
    void search_triangle(const Boundary& b, const Meshes& meshes, std::uint32_t t,
                         std::vector<Near>& found) const;

    CellGrid of;          ///< the grid of the lists
    double reach_of = 0;  ///< the reach of the lists [m]
    std::int32_t shift = 0;
    std::array<std::int32_t, 3> blocks = {0, 0, 0};
};

/// The lists of all boundaries. Those that have moved have lists of their own, so that the others are
/// searched once per grid.
class BoundaryBlocks {
public:
    /// Lists the boundaries for a grid. `reach`: largest radius and skin [m]. Returns whether the lists have
    /// changed.
    bool update(const CellGrid& grid, double reach, const std::vector<Boundary>& boundaries,
                const Meshes& meshes);

    BoundaryBlockView view() const { return {resting.view(), moving.view()}; }
    std::size_t bytes() const
    {
        return resting.bytes() + moving.bytes() + surfaces.capacity() * sizeof(Surface);
    }

    SurfaceLists resting, moving;

private:
    /// Members of a boundary that determine its surface
    struct Surface {
        Boundary::Shape shape;
        std::int32_t inside, flags;
        Vec3 r, axis;
        double radius, second_radius, from, to, cosine, sine, e0;
        Vec3 e;
        bool operator==(const Surface&) const = default;
    };
    static Surface surface_of(const Boundary& b)
    {
        return {b.shape, b.inside, b.flags,  b.r,    b.axis, b.radius, b.second_radius,
                b.from,  b.to,     b.cosine, b.sine, b.p.e0, b.p.e};
    }

    CellGrid of;           ///< the grid of the lists
    double reach_of = -1;  ///< the reach of the lists; negative: there are none
    std::vector<Surface> surfaces;
    std::vector<bool> moves;  ///< whether a boundary has moved since it was listed first
};

}  // namespace hilda::granular
