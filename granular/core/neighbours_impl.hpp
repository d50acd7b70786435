// SPDX-License-Identifier: GPL-3.0-or-later
// The functors and member functions of Neighbours for any back end.
#pragma once

#include "granular/core/neighbours.hpp"
#include "granular/core/searched_rows.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <vector>

namespace hilda::granular {

namespace detail {

/// Atomic addition; returns the previous value.
HILDA_HD inline std::uint32_t fetch_add(std::uint32_t* counter, std::uint32_t n)
{
#ifdef __CUDA_ARCH__
    return atomicAdd(counter, n);
#else
    return __atomic_fetch_add(counter, n, __ATOMIC_RELAXED);
#endif
}

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

    HILDA_HD void operator()(std::uint32_t k) const
    {
        Position p = position[k];
        std::int32_t x = grid.x_of(p.cell), y = grid.y_of(p.cell), z = grid.z_of(p.cell);
        const bool in_x = move(x, p.x, 0), in_y = move(y, p.y, 1), in_z = move(z, p.z, 2);
        order[k] = k;
        if (!(in_x && in_y && in_z)) {
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

/// Calls f(j) in a fixed order for the partners of particle k whose surfaces are closer than the skin:
/// particles, then boundaries with PairView::boundary_bit. Two fixed bodies are no pair.
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
    const Boundary* boundary;
    BoundaryBlockView near;
    SearchedRows<Backend> rows;

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
        if (velocity[k].w > small)
            search_reach(k, f);
        else
            search_half(k, f);
        if (omega[k].w == 0) return;
        const Position at = position[k];
        const std::uint32_t block = near.block(grid.x_of(at.cell), grid.y_of(at.cell), grid.z_of(at.cell));
        for (std::uint32_t n = near.start[block]; n < near.start[block + 1]; ++n) {
            const std::uint32_t b = near.boundary[n];
            if (nearest(boundary[b], global_position(grid, at)).distance < velocity[k].w + skin)
                f(PairView::boundary_bit | b);
        }
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
/// again
struct KeptPartners {
    std::uint32_t* partner;
    std::uint32_t width;
};

/// Number of partners of a particle
template <class Backend>
struct CountPairs {
    Search<Backend> search;
    std::uint32_t* count;
    KeptPartners kept;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        std::uint32_t n = 0;
        std::uint32_t* const to = kept.partner + std::size_t{k} * kept.width;
        search(k, [&](std::uint32_t other) {
            if (n < kept.width) to[n] = other;
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

/// Writes the row of a particle: partners and laws.
template <class Backend>
struct FillPairs {
    Search<Backend> search;
    KeptPartners kept;
    const std::uint32_t* start;
    std::uint32_t *i, *j;
    std::uint32_t* counts_as_j;  ///< number of pairs with a particle as j; nullptr: not counted
    std::uint8_t* law;
    const std::uint8_t* law_of;  ///< nullptr if there is a single law
    std::uint32_t materials;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        std::uint32_t n = start[k];
        const auto put = [&](std::uint32_t other) {
            i[n] = k, j[n] = other;
            const bool particle = (other & PairView::boundary_bit) == 0;
            if (particle && counts_as_j != nullptr) fetch_add(&counts_as_j[other], 1);
            if (law_of != nullptr)
                law[n] = law_of[search.species[k].material * materials +
                                (particle ? search.species[other].material
                                          : search.boundary[other & ~PairView::boundary_bit].material)];
            ++n;
        };
        const std::uint32_t count = start[k + 1] - n;
        if (count > kept.width) return search(k, put);
        const std::uint32_t* const from = kept.partner + std::size_t{k} * kept.width;
        for (std::uint32_t m = 0; m < count; ++m) put(from[m]);
    }
};

/// Saves the contacts among the pairs of a block, and those of rotation and internal variables where there
/// are any. Their order depends on the order in which the blocks are processed.
struct SaveContacts {
    static constexpr std::uint32_t block = 64;

    PairView pairs;
    std::uint32_t* count;  ///< number of contacts that are saved
    SavedContact* to;      ///< nullptr: the contacts are only counted
    Float4 *rotation, *internal;

    HILDA_HD void operator()(std::uint32_t number) const
    {
        const std::uint32_t begin = number * block,
                            end = pairs.count - begin < block ? pairs.count : begin + block;
        std::uint32_t contacts = 0;
        for (std::uint32_t n = begin; n < end; ++n) contacts += pairs.in_contact[n] != 0 ? 1 : 0;
        std::uint32_t k = fetch_add(count, contacts);
        if (to == nullptr) return;
        for (std::uint32_t n = begin; n < end; ++n) {
            if (pairs.in_contact[n] == 0) continue;
            const Float4 u = pairs.history[n];
            to[k] = {pairs.i[n], pairs.j[n], u.x, u.y, u.z, u.w};
            if (rotation != nullptr) rotation[k] = pairs.rotation_history[n];
            if (internal != nullptr) internal[k] = pairs.internal[n];
            ++k;
        }
    }
};

/// Restores a saved history in the new list. Vectors change their sign if the order of the two particles is
/// reversed; the internal variables are numbers and do not. A history whose pair is not in the new list is
/// dropped.
struct RestoreContact {
    const SavedContact* saved;
    const Float4* saved_rotation;
    const std::uint32_t* new_index;
    const std::uint32_t *start, *j;
    Float4 *history, *rotation_history;
    std::uint8_t* in_contact;
    const Float4* saved_internal;
    Float4* internal;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const SavedContact s = saved[k];
        std::uint32_t a = new_index[s.i], b = s.j;
        float sign = 1;
        if ((b & PairView::boundary_bit) == 0) {
            b = new_index[b];
            if (b < a) {
                const std::uint32_t c = a;
                a = b, b = c, sign = -1;
            }
        }
        if (restore_to(a, b, sign, s, k)) return;
        // across a periodic boundary the pair may be listed in the other order
        if ((b & PairView::boundary_bit) == 0) restore_to(b, a, -sign, s, k);
    }
    HILDA_HD bool restore_to(std::uint32_t a, std::uint32_t b, float sign, const SavedContact& s,
                             std::uint32_t k) const
    {
        for (std::uint32_t n = start[a]; n < start[a + 1]; ++n) {
            if (j[n] != b) continue;
            history[n] = {sign * s.x, sign * s.y, sign * s.z, s.w};
            in_contact[n] = 1;
            if (rotation_history != nullptr) {
                const Float4 t = saved_rotation != nullptr ? saved_rotation[k] : Float4{};
                rotation_history[n] = {sign * t.x, sign * t.y, sign * t.z, t.w};
            }
            if (saved_internal != nullptr) internal[n] = saved_internal[k];
            return true;
        }
        return false;
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

}  // namespace detail

template <class Backend>
std::size_t Neighbours<Backend>::bytes() const
{
    return key.bytes() + order.bytes() + new_index.bytes() + cell_start.bytes() + counts.bytes() +
           scratch.bytes() + saved.bytes() + saved_rotation.bytes() + saved_internal.bytes() +
           saved_count.bytes();
}

template <class Backend>
void Neighbours<Backend>::sort(const SearchInput& input, Particles<Backend>& p)
{
    const Backend on;
    const std::uint32_t n = p.count;
    const CellGrid& g = input.domain.grid;
    const auto cells =
        static_cast<std::uint32_t>(g.cells[0]) * g.cells[1] * g.cells[2] * input.domain.replicas;
    key.resize(n), order.resize(n), new_index.resize(n);
    scratch.resize(n + detail::SearchedRows<Backend>::padding);
    par::for_each(on, n,
                  detail::AssignCell{g, p.position.data(), p.species.data(), key.data(), order.data()});
    par::stable_sort_by_key(on, key.data(), order.data(), n, std::bit_width(cells));
    if (n > 0) {
        std::uint32_t last = 0;
        par::copy_to_host(on, &last, key.data() + n - 1, sizeof last);
        if (last == detail::outside_domain) {
            std::uint32_t k = 0, id = 0;
            par::copy_to_host(on, &k, order.data() + n - 1, sizeof k);
            par::copy_to_host(on, &id, p.id.data() + k, sizeof id);
            throw LeftDomain{id};
        }
    }
    par::for_each(on, n, detail::SortCells{key.data(), p.id.data(), n, order.data()});
    const auto permute = [&](auto& array) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        static_assert(sizeof(T) <= sizeof(Float4));
        auto* to = reinterpret_cast<T*>(scratch.data());
        par::gather(on, to, array.data(), order.data(), n);
        par::copy_bytes(on, array.data(), to, n * sizeof(T));
    };
    permute(p.position), permute(p.velocity), permute(p.omega), permute(p.compensation), permute(p.species),
        permute(p.id);
    if (p.acc.size() > 0) permute(p.acc), permute(p.alpha);
    if (p.orientation.size() > 0) permute(p.orientation), permute(p.orientation_compensation);
    p.position_at_build.resize(n);
    par::copy_bytes(on, p.position_at_build.data(), p.position.data(), n * sizeof(Position));
    par::for_each(on, n, detail::Invert{order.data(), new_index.data()});

    for (shift = 0; cells >> shift > 4 * std::uint64_t{n} + 4096; ++shift) continue;
    const std::uint32_t groups = (cells >> shift) + 1;
    cell_start.resize(groups + 1);
    if constexpr (std::is_same_v<Backend, par::Cpu>)
        par::for_each(on, n + 1, detail::MarkCellStarts{key.data(), n, groups, shift, cell_start.data()});
    else
        par::for_each(on, groups + 1, detail::FindCellStart{key.data(), n, shift, cell_start.data()});
}

template <class Backend>
std::uint32_t Neighbours<Backend>::save(const Pairs<Backend>& pairs, bool rotation, bool internal)
{
    const Backend on;
    const PairView view{.i = pairs.i.data(),
                        .j = pairs.j.data(),
                        .law = nullptr,
                        .history = pairs.history.data(),
                        .rotation_history = pairs.rotation_history.data(),
                        .load = nullptr,
                        .torque = nullptr,
                        .in_contact = pairs.in_contact.data(),
                        .count = pairs.count,
                        .internal = pairs.internal.data()};
    const auto each_block = [&](SavedContact* to, Float4* of_rotation, Float4* of_internal) {
        constexpr std::uint32_t block = detail::SaveContacts::block;
        saved_count.resize(1);
        par::fill(on, saved_count.data(), 1, 0u);
        par::for_each(on, (pairs.count + block - 1) / block,
                      detail::SaveContacts{view, saved_count.data(), to, of_rotation, of_internal});
    };
    each_block(nullptr, nullptr, nullptr);
    std::uint32_t contacts = 0;
    par::copy_to_host(on, &contacts, saved_count.data(), sizeof contacts);
    saved.resize(contacts), saved_rotation.resize(rotation ? contacts : 0);
    saved_internal.resize(internal ? contacts : 0);
    if (contacts > 0)
        each_block(saved.data(), rotation ? saved_rotation.data() : nullptr,
                   internal ? saved_internal.data() : nullptr);
    return contacts;
}

template <class Backend>
void Neighbours<Backend>::find(const SearchInput& input, Particles<Backend>& p, Pairs<Backend>& pairs)
{
    const Backend on;
    const std::uint32_t n = p.count;
    const bool had_rotation = input.rotation_laws && pairs.rotation_history.size() > 0,
               had_internal = input.internal && pairs.internal.size() > 0;
    const std::uint32_t contacts = save(pairs, had_rotation, had_internal);
    sort(input, p);

    const Domain& domain = input.domain;
    const detail::Search<Backend> search{
        .grid = domain.grid,
        .position = p.position.data(),
        .velocity = p.velocity.data(),
        .omega = p.omega.data(),
        .species = p.species.data(),
        .cell_start = {key.data(), cell_start.data(), shift},
        .unit = static_cast<float>(domain.grid.unit),
        .skin = domain.skin,
        .small = domain.small,
        .largest = domain.largest,
        .boundary = input.boundary,
        .near = input.near,
        .rows = {p.position.data(), p.velocity.data(), n, domain, scratch.data()}};
    counts.resize(n);
    pairs.start.resize(n + 1);
    // The histories have been saved. Their memory keeps the partners that are found.
    static_assert(sizeof(Float4) % sizeof(std::uint32_t) == 0);
    const detail::KeptPartners kept{
        reinterpret_cast<std::uint32_t*>(pairs.history.data()),
        static_cast<std::uint32_t>(pairs.history.bytes() / sizeof(std::uint32_t) / std::max(n, 1u))};
    par::for_each(on, n, detail::CountPairs<Backend>{search, counts.data(), kept});
    // Pair indices have 31 bits. The exact sum is computed only if the bound n * maximum exceeds the limit.
    const double bound = n * static_cast<double>(par::largest(on, n, detail::AsFloat{counts.data()}));
    if (bound >= PairView::boundary_bit && detail::sum(on, counts.data(), n) >= PairView::boundary_bit)
        throw TooManyPairs();
    pairs.count = static_cast<std::uint32_t>(par::exclusive_scan(on, counts.data(), pairs.start.data(), n));
    pairs.i.resize(pairs.count), pairs.j.resize(pairs.count);
    pairs.in_contact.resize(pairs.count);
    if (input.rotation_laws) pairs.rotation_history.resize(pairs.count);
    if (input.law_of != nullptr) pairs.law.resize(pairs.count);
    if (input.internal) pairs.internal.resize(pairs.count);

    constexpr bool lists_others = Pairs<Backend>::stores_all_loads;
    if constexpr (lists_others) par::fill(on, counts.data(), n, 0u);
    par::for_each(on, n,
                  detail::FillPairs<Backend>{search, kept, pairs.start.data(), pairs.i.data(), pairs.j.data(),
                                             lists_others ? counts.data() : nullptr, pairs.law.data(),
                                             input.law_of, input.materials});
    if constexpr (lists_others) {
        pairs.other_start.resize(n + 1), pairs.other.resize(pairs.count);
        par::exclusive_scan(on, counts.data(), pairs.other_start.data(), n);
        par::fill(on, counts.data(), n, 0u);
        par::for_each(on, pairs.count,
                      detail::FillOthers{pairs.i.data(), pairs.j.data(), pairs.other_start.data(),
                                         counts.data(), pairs.other.data()});
        par::for_each(on, n, detail::SortRows{pairs.other_start.data(), pairs.other.data()});
        pairs.load.resize(pairs.count);
        par::fill(on, pairs.load.data(), pairs.count, Load{});
        if (input.rotation_laws) {
            pairs.torque.resize(pairs.count);
            par::fill(on, pairs.torque.data(), pairs.count, Float4{});
        }
    }

    pairs.history.resize(pairs.count);
    par::fill(on, pairs.history.data(), pairs.count, Float4{});
    par::fill(on, pairs.in_contact.data(), pairs.count, std::uint8_t{0});
    if (input.rotation_laws) par::fill(on, pairs.rotation_history.data(), pairs.count, Float4{});
    if (input.internal) par::fill(on, pairs.internal.data(), pairs.count, Float4{});
    par::for_each(on, contacts,
                  detail::RestoreContact{
                      saved.data(), had_rotation ? saved_rotation.data() : nullptr, new_index.data(),
                      pairs.start.data(), pairs.j.data(), pairs.history.data(),
                      input.rotation_laws ? pairs.rotation_history.data() : nullptr, pairs.in_contact.data(),
                      had_internal ? saved_internal.data() : nullptr, pairs.internal.data()});
}

}  // namespace hilda::granular
