// SPDX-License-Identifier: GPL-3.0-or-later
/// Functors that find the pairs of particles and write the list.

#pragma once

#include "granular/core/neighbours/cells.hpp"
#include "granular/core/neighbours/fetch_add.hpp"
#include "granular/core/neighbours/searched_rows.hpp"

#include <numeric>
#include <vector>

namespace hilda::granular::detail {

/// Calls f(j), or f(j, image), in a fixed order for the partners of particle k whose surfaces are closer than
/// the skin: particles, then the numbers of surfaces with PairView::boundary_bit. Two fixed bodies are no
/// pair, nor are two particles of a clump.
///
/// A small particle finds the small ones in the following half of the neighbouring cells. A large particle
/// finds all small ones and the large ones with higher indices in the cells within its reach.
template <class Backend>
struct Search {
    CellGrid grid;
    const Position* position;
    const Float4 *velocity, *omega;
    const Species* species;
    CellStarts cell_start;
    float unit, skin;
    float small, largest;  ///< see Domain
    Surfaces surfaces;
    BoundaryBlockView near;
    SearchedRows<Backend> rows;
    const std::uint32_t *clump_of, *id;  ///< see AssignCell
    const std::uint8_t* ghost;           ///< see Particles; nullptr if there are none
    bool has_images;                     ///< see Domain
    std::int32_t short_axis[3];          ///< 1: several images are tested along this axis; see Domain

    /// The partners of particle k among the particles from `first` to `last` - 1. If k is small, all of them
    /// have the same periodic image.
    template <class F>
    HILDA_HD void range(std::uint32_t k, std::uint32_t first, std::uint32_t last, const F& f) const
    {
        const Position at = position[k];
        const float radius_and_skin = velocity[k].w + skin;
        const bool fixed = omega[k].w == 0, is_large = velocity[k].w > small;
        if constexpr (SearchedRows<Backend>::in_packs)
            if (!fixed && !is_large) {
                if (first < last) rows.range(grid, at, position[first], radius_and_skin, first, last, f);
                return;
            }
        for (std::uint32_t j = first; j < last; ++j) {
            if (velocity[j].w > small && !(is_large && j > k)) continue;
            const Difference d = difference(grid, at, position[j]);
            const float x = unit * static_cast<float>(d.x), y = unit * static_cast<float>(d.y),
                        z = unit * static_cast<float>(d.z), limit = radius_and_skin + velocity[j].w;
            if (x * x + y * y + z * z < limit * limit && !(fixed && omega[j].w == 0)) f(j);
        }
    }

    /// Cells along an axis that are within the reach of a particle: `count` cells from `first` on. Along a
    /// periodic axis `first` may be negative, and first + count above the number of cells.
    struct Cells {
        std::int32_t first, count;
    };
    HILDA_HD Cells cells_within(float reach, std::int32_t cell, int axis) const
    {
        const std::int32_t n = grid.cells[axis];
        const auto each_side =
            static_cast<std::int32_t>(reach / (unit * static_cast<float>(grid.width[axis]))) + 2;
        if (grid.periodic[axis] != 0)
            return 2 * each_side + 1 < n ? Cells{cell - each_side, 2 * each_side + 1} : Cells{0, n};
        const std::int32_t first = cell > each_side ? cell - each_side : 0,
                           last = cell + each_side < n ? cell + each_side : n - 1;
        return {first, last - first + 1};
    }
    HILDA_HD static std::int32_t wrapped(std::int32_t cell, std::int32_t cells)
    {
        return cell < 0 ? cell + cells : cell >= cells ? cell - cells : cell;
    }

    template <class F>
    HILDA_HD void search_reach(std::uint32_t k, const F& f) const
    {
        const std::uint32_t cell = position[k].cell, replica = species[k].replica;
        const float reach = velocity[k].w + largest + skin;
        const Cells x = cells_within(reach, grid.x_of(cell), 0), y = cells_within(reach, grid.y_of(cell), 1),
                    z = cells_within(reach, grid.z_of(cell), 2);
        const std::int32_t nx = grid.cells[0], ny = grid.cells[1], nz = grid.cells[2];
        for (std::int32_t c = z.first; c < z.first + z.count; ++c)
            for (std::int32_t b = y.first; b < y.first + y.count; ++b) {
                const std::uint32_t base = ((replica * nz + wrapped(c, nz)) * ny + wrapped(b, ny)) * nx;
                const std::int32_t end = x.first + x.count;
                const auto row = [&](std::int32_t from, std::int32_t to) {  // without a periodic boundary
                    if (from < to) range_without(k, cell_start[base + from], cell_start[base + to], f);
                };
                row(x.first < 0 ? x.first + nx : nx, nx);
                row(x.first < 0 ? 0 : x.first, end < nx ? end : nx);
                row(0, end > nx ? end - nx : 0);
            }
    }
    /// Particle k and all images of the other particles in the cells within its reach. A large particle finds
    /// all small ones. Of two particles of the same kind that with the lower index finds the other one. Not
    /// inlined, so that the code of other domains stays fast.
    template <class F>
    [[gnu::noinline]] HILDA_HD void search_images(std::uint32_t k, const F& f) const
    {
        const Position at = position[k];
        const std::uint32_t cell = at.cell, replica = species[k].replica;
        const float radius_and_skin = velocity[k].w + skin;
        const bool fixed = omega[k].w == 0, is_large = velocity[k].w > small;
        const float reach = radius_and_skin + (is_large ? largest : small);
        const Cells x = cells_within(reach, grid.x_of(cell), 0), y = cells_within(reach, grid.y_of(cell), 1),
                    z = cells_within(reach, grid.z_of(cell), 2);
        const std::int32_t nx = grid.cells[0], ny = grid.cells[1], nz = grid.cells[2];
        const auto test = [&](std::uint32_t j, std::int32_t a, std::int32_t b, std::int32_t c) {
            const std::uint8_t image = Image::pack(a, b, c);
            const Difference d = difference(grid, at, position[j], image);
            const float dx = unit * static_cast<float>(d.x), dy = unit * static_cast<float>(d.y),
                        dz = unit * static_cast<float>(d.z), limit = radius_and_skin + velocity[j].w;
            if (dx * dx + dy * dy + dz * dz < limit * limit) f(j, image);
        };
        const auto images = [&](std::uint32_t j) {
            if (j == k || (fixed && omega[j].w == 0)) return;
            if (velocity[j].w > small ? !(is_large && j > k) : !(is_large || j > k)) return;
            const std::uint32_t other = position[j].cell;
            const std::int32_t a_0 = nearest_period(grid.x_of(cell), grid.x_of(other), grid, 0),
                               b_0 = nearest_period(grid.y_of(cell), grid.y_of(other), grid, 1),
                               c_0 = nearest_period(grid.z_of(cell), grid.z_of(other), grid, 2);
            const std::int32_t m = short_axis[0], n = short_axis[1], o = short_axis[2];
            for (std::int32_t c = o != 0 ? -1 : c_0; c <= (o != 0 ? 1 : c_0); ++c)
                for (std::int32_t b = n != 0 ? -1 : b_0; b <= (n != 0 ? 1 : b_0); ++b)
                    for (std::int32_t a = m != 0 ? -1 : a_0; a <= (m != 0 ? 1 : a_0); ++a) test(j, a, b, c);
        };
        for (std::int32_t c = z.first; c < z.first + z.count; ++c)
            for (std::int32_t b = y.first; b < y.first + y.count; ++b)
                for (std::int32_t a = x.first; a < x.first + x.count; ++a) {
                    const std::uint32_t at_cell =
                        ((replica * nz + wrapped(c, nz)) * ny + wrapped(b, ny)) * nx + wrapped(a, nx);
                    for (std::uint32_t j = cell_start[at_cell]; j < cell_start[at_cell + 1]; ++j) images(j);
                }
    }
    /// range() without the particle itself
    template <class F>
    HILDA_HD void range_without(std::uint32_t k, std::uint32_t first, std::uint32_t last, const F& f) const
    {
        if (k < first || k >= last) return range(k, first, last, f);
        range(k, first, k, f), range(k, k + 1, last, f);
    }

    template <class F>
    HILDA_HD void operator()(std::uint32_t k, const F& f) const
    {
        if (ghost != nullptr && ghost[k] != 0)
            return find(k, [&](std::uint32_t other, std::uint8_t image = Image::none) {
                if ((other & PairView::boundary_bit) == 0 && ghost[other] == 0) f(other, image);
            });
        const std::uint32_t own = clump_of == nullptr ? no_clump : clump_of[id[k]];
        if (own == no_clump) return find(k, f);
        find(k, [&](std::uint32_t other, std::uint8_t image = Image::none) {
            if ((other & PairView::boundary_bit) != 0 || clump_of[id[other]] != own) f(other, image);
        });
    }

    template <class F>
    HILDA_HD void find(std::uint32_t k, const F& f) const
    {
        if (has_images)
            search_images(k, f);
        else if (velocity[k].w > small)
            search_reach(k, f);
        else
            search_half(k, f);
        if (omega[k].w == 0) return;
        const Position at = position[k];
        const Vec3 r = global_position(grid, at);
        near.each(grid.x_of(at.cell), grid.y_of(at.cell), grid.z_of(at.cell), [&](std::uint32_t surface) {
            if (surfaces.is_near(surface, r, velocity[k].w, skin)) f(PairView::boundary_bit | surface);
        });
    }

    template <class F>
    HILDA_HD void search_half(std::uint32_t k, const F& f) const
    {
        const std::uint32_t cell = position[k].cell;
        const std::int32_t x = grid.x_of(cell), y = grid.y_of(cell), z = grid.z_of(cell);
        const std::int32_t nx = grid.cells[0], ny = grid.cells[1], nz = grid.cells[2];
        const std::uint32_t replica = species[k].replica;
        // Half of the 27 cells: those that follow in the order z, y, x of an infinite grid, so that each pair
        // is found once. The cells of a row (y, z) are contiguous in memory except across a periodic
        // boundary.
        for (int row = 0; row < 5; ++row) {
            std::int32_t yy = y + (row == 0 ? 0 : row == 1 ? 1 : row - 3), zz = z + (row > 1 ? 1 : 0);
            if (yy < 0 || yy >= ny) {
                if (grid.periodic[1] == 0) continue;
                yy += yy < 0 ? ny : -ny;
            }
            if (zz >= nz) {
                if (grid.periodic[2] == 0) continue;
                zz -= nz;
            }
            const std::uint32_t base = ((replica * nz + zz) * ny + yy) * nx;
            const std::int32_t from = row == 0 ? x : x - 1, to = x + 1;
            const std::uint32_t first = row == 0 ? k + 1 : cell_start[base + (from < 0 ? 0 : from)];
            const std::uint32_t last = cell_start[base + (to < nx ? to : nx - 1) + 1];
            range(k, first, last, f);
            if (grid.periodic[0] == 0) continue;
            if (row != 0 && from < 0) range(k, cell_start[base + nx - 1], cell_start[base + nx], f);
            if (to >= nx) range(k, cell_start[base], cell_start[base + 1], f);
        }
    }
};

/// The partners that CountPairs finds, up to `width` of each particle, so that FillPairs does not search
/// again; width is 0 where partners have images
struct FoundPartners {
    std::uint32_t* partner;
    std::uint32_t width;
};

/// Number of partners of a particle
template <class Backend>
struct CountPairs {
    Search<Backend> search;
    std::uint32_t* count;
    FoundPartners found;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        std::uint32_t n = 0;
        std::uint32_t* const to = found.partner + std::size_t{k} * found.width;
        search(k, [&](std::uint32_t other, std::uint8_t = Image::none) {
            if (n < found.width) to[n] = other;
            ++n;
        });
        count[k] = n;
    }
};

/// Number of partners of a particle as a float, for par::largest
struct AsFloat {
    const std::uint32_t* number;
    HILDA_HD float operator()(std::uint32_t k) const { return static_cast<float>(number[k]); }
};
/// Sum on the host
template <class Backend>
std::uint64_t sum(Backend on, const std::uint32_t* numbers, std::uint32_t n)
{
    std::vector<std::uint32_t> all(n);
    par::copy_to_host(on, all.data(), numbers, n * sizeof *numbers);
    return std::accumulate(all.begin(), all.end(), std::uint64_t{0});
}

/// Writes the row of a particle: partners, images and laws.
template <class Backend>
struct FillPairs {
    Search<Backend> search;
    FoundPartners found;
    const std::uint32_t* start;
    std::uint32_t *i, *j;
    std::uint32_t* counts_as_j;  ///< number of pairs with a particle as j; nullptr: not counted
    std::uint8_t* law;
    const std::uint8_t* law_of;  ///< nullptr if there is a single law
    std::uint32_t materials;
    std::uint8_t* image;  ///< nullptr: the partners have no images

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const auto boundary = [&](std::uint32_t other) -> const Boundary& {
            const Surfaces& s = search.surfaces;
            return s.boundary[s.boundary_of(other & ~PairView::boundary_bit)];
        };
        std::uint32_t n = start[k];
        const auto put = [&](std::uint32_t other, std::uint8_t image_of_other = Image::none) {
            i[n] = k, j[n] = other;
            if (image != nullptr) image[n] = image_of_other;
            const bool particle = (other & PairView::boundary_bit) == 0;
            if (particle && counts_as_j != nullptr) fetch_add(&counts_as_j[other], 1);
            if (law_of != nullptr)
                law[n] = law_of[search.species[k].material * materials +
                                (particle ? search.species[other].material : boundary(other).material)];
            ++n;
        };
        const std::uint32_t count = start[k + 1] - n;
        if (count > found.width) return search(k, put);
        const std::uint32_t* const from = found.partner + std::size_t{k} * found.width;
        for (std::uint32_t m = 0; m < count; ++m) put(from[m]);
    }
};

/// Fills the rows of the pairs in which a particle is j.
struct FillOthers {
    const std::uint32_t *i, *j, *other_start;
    std::uint32_t *next, *other;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        if ((j[n] & PairView::boundary_bit) != 0) return;
        other[other_start[j[n]] + fetch_add(&next[j[n]], 1)] = n;
    }
};

/// Sorts a row, because the threads fill it in an arbitrary order.
struct SortRows {
    const std::uint32_t* start;
    std::uint32_t* value;
    HILDA_HD void operator()(std::uint32_t p) const
    {
        for (std::uint32_t a = start[p] + 1; a < start[p + 1]; ++a) {
            const std::uint32_t v = value[a];
            std::uint32_t b = a;
            for (; b > start[p] && value[b - 1] > v; --b) value[b] = value[b - 1];
            value[b] = v;
        }
    }
};

}  // namespace hilda::granular::detail
