// SPDX-License-Identifier: GPL-3.0-or-later
/// Where particles are, in whole numbers, and how they move.                              Fang (2022), Secs. 6.1, 6.2

#pragma once

#include "granular/backend/real.hpp"

#include <cstdint>

namespace hilda::granular {

/// A cell of the grid and the place in it. Differences of near particles are exact, wherever in the domain they are.
struct alignas(16) Position {
    std::uint32_t cell =
        0;  ///< Grid::pack() of the cell that owned the particle when neighbours were last looked for
    std::int32_t x = 0, y = 0, z = 0;  ///< from the low corner of that cell, in Grid::unit
};

struct alignas(16) Four {
    float x = 0, y = 0, z = 0, w = 0;
};

/// What a particle is made of, and which system it belongs to
struct Species {
    std::uint16_t material = 0, replica = 0;
};

/// What rounding left of ways, velocities and turnings for the next step: three times ten bits of a unit, and numbers of
/// single precision without their lower half.
struct alignas(16) Compensation {
    std::int32_t way = 0;                                  ///< see carried
    std::uint16_t v[3] = {0, 0, 0}, omega[3] = {0, 0, 0};  ///< [m/s, rad/s]
};

/// Takes x to its upper half, to the next larger |x| as often as it is nearer to that one: `dither` is at random in
/// [0, 2^16), so that what is small and the same in every step is not lost. Mirrored numbers become mirrored ones: two
/// bodies that are mirror images keep their momentum of zero to the bit.
constexpr std::uint32_t to_nearest = 1u << 15;
template <class R>
HILDA_HD inline Int<R> upper_half(const R& x, std::uint32_t dither)
{
    return (as_int(x) + static_cast<std::int32_t>(dither)) & static_cast<std::int32_t>(0xFFFF0000);
}
HILDA_HD inline void put_halves(std::uint16_t* three, const Vec<float>& x, std::uint32_t dither)
{
    const auto half = [&](float of) {
        return static_cast<std::uint16_t>(static_cast<std::uint32_t>(upper_half(of, dither)) >> 16);
    };
    three[0] = half(x.x), three[1] = half(x.y), three[2] = half(x.z);
}
HILDA_HD inline Vec<float> from_halves(const std::uint16_t* three)
{
    const auto whole = [](std::uint16_t half) {
        return as_float(static_cast<std::int32_t>(std::uint32_t{half} << 16));
    };
    return {whole(three[0]), whole(three[1]), whole(three[2])};
}

/// The whole units of a way, and a word of what is left of it, in 1024ths; `dither` goes evenly through (-1/2, 1/2).
template <class R>
struct Carried {
    Int<R> x, y, z, word;
};
template <class R>
HILDA_HD inline Vec<R> rest_of_way(const Int<R>& word)  ///< [units]
{
    const auto part = [](const Int<R>& of) { return R(0x1p-10f) * to_float(of >> 22); };
    return {part(word << 22), part(word << 12), part(word << 2)};
}
template <class R>
HILDA_HD inline Carried<R> carried(const Vec<R>& way, float dither)
{
    const auto split = [&](const R& all, Int<R>& units) {
        const R whole = rint(all);
        const Int<R> grains = to_int(rint(R(0x1p10f) * (all - whole) + R(dither)));
        units = to_int(whole) + ((grains + 512) >> 10);  // grains are from -512 to 511 in a word
        return grains & 1023;
    };
    Carried<R> out;
    const Int<R> x = split(way.x, out.x), y = split(way.y, out.y), z = split(way.z, out.z);
    out.word = x | (y << 10) | (z << 20);
    return out;
}

/// Cells of a box-shaped domain, at least as wide as the largest particle and the skin
struct CellGrid {
    static constexpr int bits_x = 11, bits_y = 11, bits_z = 10;
    static constexpr std::int32_t widest = 1 << 29;  ///< cell, in units

    double low[3] = {0, 0, 0};  ///< corner of the domain [m]
    double unit = 1;            ///< [m]
    std::int32_t cells[3] = {1, 1, 1};
    std::int32_t width[3] = {widest, widest, widest};  ///< of a cell, in units
    std::int32_t last[3] = {widest, widest,
                            widest};       ///< how much of the last cell is in the domain, in units
    std::int32_t periodic[3] = {0, 0, 0};  ///< 1 where what leaves on one side enters on the other

    HILDA_HD static std::uint32_t pack(std::uint32_t x, std::uint32_t y, std::uint32_t z)
    {
        return x | y << bits_x | z << (bits_x + bits_y);
    }
    HILDA_HD static std::int32_t x_of(std::uint32_t cell) { return cell & ((1u << bits_x) - 1); }
    HILDA_HD static std::int32_t y_of(std::uint32_t cell) { return cell >> bits_x & ((1u << bits_y) - 1); }
    HILDA_HD static std::int32_t z_of(std::uint32_t cell) { return cell >> (bits_x + bits_y); }
};

/// i - j along one axis, in units; by the shorter way round where the domain is periodic. Steps over 2^31 on the way there
/// cancel: what is near is less than that away.
HILDA_HD inline std::int32_t difference(std::int32_t cell_i, std::int32_t cell_j, std::int32_t i,
                                        std::int32_t j, const CellGrid& g, int axis)
{
    std::int32_t d = cell_i - cell_j;
    if (g.periodic[axis] != 0)
        d += 2 * d > g.cells[axis] ? -g.cells[axis] : 2 * d < -g.cells[axis] ? g.cells[axis] : 0;
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(d) *
                                         static_cast<std::uint32_t>(g.width[axis]) +
                                     (static_cast<std::uint32_t>(i) - static_cast<std::uint32_t>(j)));
}

struct Difference {
    std::int32_t x, y, z;
};
HILDA_HD inline Difference difference(const CellGrid& g, const Position& i, const Position& j)
{
    return {difference(CellGrid::x_of(i.cell), CellGrid::x_of(j.cell), i.x, j.x, g, 0),
            difference(CellGrid::y_of(i.cell), CellGrid::y_of(j.cell), i.y, j.y, g, 1),
            difference(CellGrid::z_of(i.cell), CellGrid::z_of(j.cell), i.z, j.z, g, 2)};
}

/// [m]
HILDA_HD inline Vec<double> place(const CellGrid& g, const Position& p)
{
    return {g.low[0] + (static_cast<double>(CellGrid::x_of(p.cell)) * g.width[0] + p.x) * g.unit,
            g.low[1] + (static_cast<double>(CellGrid::y_of(p.cell)) * g.width[1] + p.y) * g.unit,
            g.low[2] + (static_cast<double>(CellGrid::z_of(p.cell)) * g.width[2] + p.z) * g.unit};
}

/// The radius in units, as both sides of a pair see it
HILDA_HD inline std::int32_t in_units(float radius, float per_metre)
{
    return static_cast<std::int32_t>(radius * per_metre);
}

}  // namespace hilda::granular
