// SPDX-License-Identifier: GPL-3.0-or-later
// The functors of Neighbours, for any back end.
#pragma once

#include "granular/core/neighbours.hpp"

#include <bit>
#include <cstring>
#include <numeric>
#include <vector>

namespace hilda::granular {

namespace detail {

/// Adds one and returns what was there
HILDA_HD inline std::uint32_t take_next(std::uint32_t* counter)
{
#ifdef __CUDA_ARCH__
    return atomicAdd(counter, 1u);
#else
    return __atomic_fetch_add(counter, 1u, __ATOMIC_RELAXED);
#endif
}

/// The cell a particle is in now; its place becomes that in the cell. Its sort key has the replica, the cell in order of
/// z, y, x and then the id; all bits set where it has left the domain.
struct Settle {
    CellGrid grid;
    Position* position;
    const Species* kind;
    const std::uint32_t* id;
    std::uint64_t* key;
    std::uint32_t* order;

    HILDA_HD bool move(std::int32_t& cell, std::int32_t& at, int axis) const
    {
        const std::int32_t width = grid.width[axis], cells = grid.cells[axis];
        std::int32_t steps = at / width;
        if (at < 0 && steps * width != at) --steps;  // towards minus infinity
        at -= steps * width;
        cell += steps;
        if (grid.periodic[axis] != 0) {
            cell += cell < 0 ? cells : cell >= cells ? -cells : 0;
            return true;
        }
        return cell >= 0 && (cell < cells - 1 || (cell == cells - 1 && at <= grid.last[axis]));
    }

    HILDA_HD void operator()(std::uint32_t k) const
    {
        Position p = position[k];
        std::int32_t x = CellGrid::x_of(p.cell), y = CellGrid::y_of(p.cell), z = CellGrid::z_of(p.cell);
        const bool in_x = move(x, p.x, 0), in_y = move(y, p.y, 1), in_z = move(z, p.z, 2);
        order[k] = k;
        if (!(in_x && in_y && in_z)) {
            key[k] = ~std::uint64_t{0};
            return;
        }
        p.cell = CellGrid::pack(x, y, z);
        position[k] = p;
        const std::uint64_t row =
            (static_cast<std::uint64_t>(kind[k].replica) * grid.cells[2] + z) * grid.cells[1] + y;
        const std::uint64_t number = row * grid.cells[0] + x;
        key[k] = number << 32 | id[k];
    }
};

/// start[c] is the first of the particles in cell c or a later one; one more entry than there are cells
struct StartCells {
    const std::uint64_t* key;
    std::uint32_t particles, cells;
    std::uint32_t* start;

    HILDA_HD void operator()(std::uint32_t k) const  // k up to and with the number of particles
    {
        const std::uint32_t here = k < particles ? static_cast<std::uint32_t>(key[k] >> 32) : cells;
        for (std::uint32_t c = k > 0 ? static_cast<std::uint32_t>(key[k - 1] >> 32) + 1 : 0; c <= here; ++c)
            start[c] = k;
    }
};

/// The same, a cell at a time: no thread has many empty ones to fill
struct FindStart {
    const std::uint64_t* key;
    std::uint32_t particles;
    std::uint32_t* start;

    HILDA_HD void operator()(std::uint32_t c) const
    {
        std::uint32_t low = 0, high = particles;
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            if ((key[middle] >> 32) < c)
                low = middle + 1;
            else
                high = middle;
        }
        start[c] = low;
    }
};

struct Invert {
    const std::uint32_t* order;
    std::uint32_t* where;
    HILDA_HD void operator()(std::uint32_t k) const { where[order[k]] = k; }
};

/// Calls f(j) for the particles after k that are within reach of it, in a fixed order.
struct Search {
    CellGrid grid;
    const Position* position;
    const Four *velocity, *omega;
    const Species* kind;
    const std::uint32_t* cell_start;
    float metre, skin;
    const Boundary* boundary;
    std::uint32_t boundaries;

    template <class F>
    HILDA_HD void range(std::uint32_t k, std::uint32_t first, std::uint32_t last, const F& f) const
    {
        const Position at = position[k];
        const float reach = velocity[k].w + skin;
        const bool fixed = omega[k].w == 0;
        for (std::uint32_t j = first; j < last; ++j) {
            const Difference d = difference(grid, at, position[j]);
            const float x = metre * static_cast<float>(d.x), y = metre * static_cast<float>(d.y),
                        z = metre * static_cast<float>(d.z), far = reach + velocity[j].w;
            if (x * x + y * y + z * z < far * far && !(fixed && omega[j].w == 0)) f(j);
        }
    }

    template <class F>
    HILDA_HD void operator()(std::uint32_t k, const F& f) const
    {
        const std::uint32_t cell = position[k].cell;
        const std::int32_t x = CellGrid::x_of(cell), y = CellGrid::y_of(cell), z = CellGrid::z_of(cell);
        const std::int32_t nx = grid.cells[0], ny = grid.cells[1], nz = grid.cells[2];
        const std::uint32_t replica = kind[k].replica;
        // Of the 27 cells around, those after this one in the order z, y, x of an endless grid: rows (y, z) of three
        // cells, which are neighbours in memory but where the domain is periodic.
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
        for (std::uint32_t b = 0; b < boundaries; ++b)
            if (omega[k].w != 0 &&
                nearest(boundary[b], place(grid, position[k])).distance < velocity[k].w + skin)
                f(PairView::boundary | b);
    }
};

struct CountPairs {
    Search search;
    std::uint32_t* count;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        std::uint32_t n = 0;
        search(k, [&](std::uint32_t) { ++n; });
        count[k] = n;
    }
};

struct AsFloat {
    const std::uint32_t* number;
    HILDA_HD float operator()(std::uint32_t k) const { return static_cast<float>(number[k]); }
};
template <class Backend>
std::uint64_t sum(Backend on, const std::uint32_t* numbers, std::uint32_t n)
{
    std::vector<std::uint32_t> all(n);
    par::copy_to_host(on, all.data(), numbers, n * sizeof *numbers);
    return std::accumulate(all.begin(), all.end(), std::uint64_t{0});
}

struct FillPairs {
    Search search;
    const std::uint32_t* start;
    std::uint32_t *i, *j;
    std::uint32_t* others;  ///< counts those that have a particle as j
    std::uint8_t* law;
    const std::uint8_t* law_of;  ///< nullptr where there is one law
    std::uint32_t materials;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        std::uint32_t n = start[k];
        search(k, [&](std::uint32_t other) {
            i[n] = k, j[n] = other;
            const bool particle = (other & PairView::boundary) == 0;
            if (particle) take_next(&others[other]);
            if (law_of != nullptr)
                law[n] = law_of[search.kind[k].material * materials +
                                (particle ? search.kind[other].material
                                          : search.boundary[other & ~PairView::boundary].material)];
            ++n;
        });
    }
};

/// A pair that touches, where nobody looks until loads are found again
struct Saved {
    std::uint32_t i, j;
    float age, x;
    float y, z;
    std::uint32_t touches, unused;
};
static_assert(sizeof(Saved) == sizeof(Load));

struct Save {
    PairView pairs;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        const Four u = pairs.history[k];
        auto* to = reinterpret_cast<Saved*>(&pairs.load[k]);
        *to = {pairs.i[k], pairs.j[k], u.w, u.x, u.y, u.z, pairs.touches[k], 0};
        if (pairs.turning != nullptr) pairs.torque[k] = pairs.turning[k];
    }
};

struct Restore {
    const Saved* saved;
    const Four* saved_turning;
    const std::uint32_t* where;
    const std::uint32_t *start, *j;
    Four *history, *turning;
    std::uint8_t* touches;

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const Saved s = saved[k];
        if (s.touches == 0) return;
        std::uint32_t a = where[s.i], b = s.j;
        float sign = 1;
        if ((b & PairView::boundary) == 0) {
            b = where[b];
            if (b < a) {
                const std::uint32_t c = a;
                a = b, b = c, sign = -1;
            }
        }
        if (put(a, b, sign, s, k)) return;
        // across a periodic face the order may be the other way round
        if ((b & PairView::boundary) == 0) put(b, a, -sign, s, k);
    }
    HILDA_HD bool put(std::uint32_t a, std::uint32_t b, float sign, const Saved& s, std::uint32_t k) const
    {
        for (std::uint32_t n = start[a]; n < start[a + 1]; ++n) {
            if (j[n] != b) continue;
            history[n] = {sign * s.x, sign * s.y, sign * s.z, s.age};
            touches[n] = 1;
            if (turning != nullptr) {
                const Four t = saved_turning != nullptr ? saved_turning[k] : Four{};
                turning[n] = {sign * t.x, sign * t.y, sign * t.z, t.w};
            }
            return true;
        }
        return false;
    }
};

struct FillOthers {
    const std::uint32_t *i, *j, *other_start;
    std::uint32_t *next, *other;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        if ((j[n] & PairView::boundary) != 0) return;
        other[other_start[j[n]] + take_next(&next[j[n]])] = n;
    }
};

/// Rows that threads have filled in any order, into one order
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
    return key.bytes() + order.bytes() + where.bytes() + cell_start.bytes() + counts.bytes() +
           scratch.bytes();
}

template <class Backend>
void Neighbours<Backend>::sort(const Reach& reach, Particles<Backend>& p)
{
    const Backend on;
    const std::uint32_t n = p.count;
    const CellGrid& g = reach.scene.grid;
    const auto cells =
        static_cast<std::uint32_t>(g.cells[0]) * g.cells[1] * g.cells[2] * reach.scene.replicas;
    key.resize(n), order.resize(n), where.resize(n), scratch.resize(n);
    par::for_each(on, n,
                  detail::Settle{g, p.position.data(), p.kind.data(), p.id.data(), key.data(), order.data()});
    par::stable_sort_by_key(on, key.data(), order.data(), n, 32 + std::bit_width(cells));
    if (n > 0) {
        std::uint64_t last = 0;
        par::copy_to_host(on, &last, key.data() + n - 1, sizeof last);
        if (last == ~std::uint64_t{0}) {
            std::uint32_t k = 0, id = 0;
            par::copy_to_host(on, &k, order.data() + n - 1, sizeof k);
            par::copy_to_host(on, &id, p.id.data() + k, sizeof id);
            throw LeftDomain{id};
        }
    }
    const auto permute = [&](auto& array) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        static_assert(sizeof(T) <= sizeof(Four));
        auto* to = reinterpret_cast<T*>(scratch.data());
        par::gather(on, to, array.data(), order.data(), n);
        par::copy_bytes(on, array.data(), to, n * sizeof(T));
    };
    permute(p.position), permute(p.velocity), permute(p.omega), permute(p.rest), permute(p.kind),
        permute(p.id);
    if (p.acc.size() > 0) permute(p.acc), permute(p.turn);
    if (p.orientation.size() > 0) permute(p.orientation), permute(p.orientation_rest);
    p.before.resize(n);
    par::copy_bytes(on, p.before.data(), p.position.data(), n * sizeof(Position));
    par::for_each(on, n, detail::Invert{order.data(), where.data()});

    cell_start.resize(cells + 1);
    if constexpr (std::is_same_v<Backend, par::Cpu>)
        par::for_each(on, n + 1, detail::StartCells{key.data(), n, cells, cell_start.data()});
    else
        par::for_each(on, cells + 1, detail::FindStart{key.data(), n, cell_start.data()});
}

template <class Backend>
void Neighbours<Backend>::find(const Reach& reach, Particles<Backend>& p, Pairs<Backend>& pairs)
{
    const Backend on;
    const std::uint32_t n = p.count, before = pairs.count;
    const PairView old{pairs.i.data(),
                       pairs.j.data(),
                       nullptr,
                       pairs.history.data(),
                       reach.turning && pairs.turning.size() > 0 ? pairs.turning.data() : nullptr,
                       pairs.load.data(),
                       pairs.torque.data(),
                       pairs.touches.data(),
                       before};
    par::for_each(on, before, detail::Save{old});
    sort(reach, p);

    const Scene& scene = reach.scene;
    const detail::Search search{.grid = scene.grid,
                                .position = p.position.data(),
                                .velocity = p.velocity.data(),
                                .omega = p.omega.data(),
                                .kind = p.kind.data(),
                                .cell_start = cell_start.data(),
                                .metre = static_cast<float>(scene.grid.unit),
                                .skin = scene.skin,
                                .boundary = reach.boundary,
                                .boundaries = reach.boundaries};
    counts.resize(n);
    pairs.start.resize(n + 1), pairs.other_start.resize(n + 1);
    par::for_each(on, n, detail::CountPairs{search, counts.data()});
    // numbers of pairs are of 32 bits, the highest for boundaries
    const double most = n * static_cast<double>(par::largest(on, n, detail::AsFloat{counts.data()}));
    if (most >= PairView::boundary && detail::sum(on, counts.data(), n) >= PairView::boundary)
        throw TooManyPairs();
    pairs.count = static_cast<std::uint32_t>(par::exclusive_scan(on, counts.data(), pairs.start.data(), n));
    pairs.i.resize(pairs.count), pairs.j.resize(pairs.count), pairs.other.resize(pairs.count);
    pairs.history.resize(pairs.count), pairs.touches.resize(pairs.count);
    if (reach.turning) pairs.turning.resize(pairs.count);
    if (reach.law_of != nullptr) pairs.law.resize(pairs.count);

    par::fill(on, counts.data(), n, 0u);
    par::for_each(on, n,
                  detail::FillPairs{search, pairs.start.data(), pairs.i.data(), pairs.j.data(), counts.data(),
                                    pairs.law.data(), reach.law_of, reach.materials});
    par::exclusive_scan(on, counts.data(), pairs.other_start.data(), n);
    par::fill(on, counts.data(), n, 0u);
    par::for_each(on, pairs.count,
                  detail::FillOthers{pairs.i.data(), pairs.j.data(), pairs.other_start.data(), counts.data(),
                                     pairs.other.data()});
    par::for_each(on, n, detail::SortRows{pairs.other_start.data(), pairs.other.data()});

    par::fill(on, pairs.history.data(), pairs.count, Four{});
    par::fill(on, pairs.touches.data(), pairs.count, std::uint8_t{0});
    if (reach.turning) par::fill(on, pairs.turning.data(), pairs.count, Four{});
    par::for_each(on, before,
                  detail::Restore{reinterpret_cast<const detail::Saved*>(pairs.load.data()),
                                  old.turning != nullptr ? pairs.torque.data() : nullptr, where.data(),
                                  pairs.start.data(), pairs.j.data(), pairs.history.data(),
                                  reach.turning ? pairs.turning.data() : nullptr, pairs.touches.data()});
    pairs.load.resize(pairs.count);
    par::fill(on, pairs.load.data(), pairs.count, Load{});
    if (reach.turning) {
        pairs.torque.resize(pairs.count);
        par::fill(on, pairs.torque.data(), pairs.count, Four{});
    }
}

}  // namespace hilda::granular
