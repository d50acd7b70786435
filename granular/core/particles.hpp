// SPDX-License-Identifier: GPL-3.0-or-later
/// Particle state: integer positions in a cell grid, rounding remainders.         Fang (2022), Secs. 6.1, 6.2

#pragma once

#include "granular/backend/real.hpp"

#include <cstdint>

namespace hilda::granular {

/// Position of a particle centre: owner cell and local integer coordinates.
///
/// The difference of two neighbouring positions is an exact integer, wherever they are in the domain. The
/// owner cell is assigned at a neighbour search. Between searches only the local coordinates change, and they
/// may lie outside [0, CellGrid::width).
struct alignas(16) Position {
    std::uint32_t cell = 0;            ///< owner cell, packed by CellGrid::pack()
    std::int32_t x = 0, y = 0, z = 0;  ///< relative to the low corner of the owner cell [CellGrid::unit]
};

/// Four floats in one 16-byte word: a vector and one scalar.
struct alignas(16) Float4 {
    float x = 0, y = 0, z = 0, w = 0;
};
/// The vector
HILDA_HD inline Vec<double> to_double(const Float4& f) { return {f.x, f.y, f.z}; }

/// Species of a particle: its material and its replica. Particles of different replicas do not interact.
struct Species {
    std::uint16_t material = 0, replica = 0;
};

/// Compensation of a particle: the rounding remainders of one step, which are added in the next step (Kahan
/// summation).
///
/// The remainder of the displacement has 10 bits per axis. The remainders of the velocities are stored as
/// bfloat16, the upper 16 bits of a float.
struct alignas(16) Compensation {
    std::int32_t displacement = 0;                         ///< packed remainder; see SplitDisplacement
    std::uint16_t v[3] = {0, 0, 0}, omega[3] = {0, 0, 0};  ///< [m/s, rad/s]
};

/// The dither for which round_to_bfloat16() rounds to nearest
constexpr std::uint32_t dither_to_nearest = 1u << 15;
/// The bits of x rounded to bfloat16, in the upper 16 bits of the result.
///
/// Stochastic rounding: for a random `dither`, uniformly distributed over the integers in [0, 2^16), |x| is
/// rounded up with a probability equal to the discarded fraction. A small constant contribution per step is
/// therefore preserved on average. The rounding is odd, round(-x) = -round(x). The total momentum of a
/// mirror-symmetric system therefore remains exactly zero.
template <class R>
HILDA_HD inline Int<R> round_to_bfloat16(const R& x, std::uint32_t dither)
{
    return (as_int(x) + static_cast<std::int32_t>(dither)) & static_cast<std::int32_t>(0xFFFF0000);
}
/// Stores the three components of x as bfloat16; see round_to_bfloat16().
HILDA_HD inline void store_bfloat16(std::uint16_t* three, const Vec<float>& x, std::uint32_t dither)
{
    const auto half = [&](float component) {
        return static_cast<std::uint16_t>(static_cast<std::uint32_t>(round_to_bfloat16(component, dither)) >>
                                          16);
    };
    three[0] = half(x.x), three[1] = half(x.y), three[2] = half(x.z);
}
/// The inverse of store_bfloat16
HILDA_HD inline Vec<float> load_bfloat16(const std::uint16_t* three)
{
    const auto to_float32 = [](std::uint16_t half) {
        return as_float(static_cast<std::int32_t>(std::uint32_t{half} << 16));
    };
    return {to_float32(three[0]), to_float32(three[1]), to_float32(three[2])};
}

/// A displacement split into whole units x, y, z and a remainder. The remainder consists of three signed
/// 10-bit numbers in units of 1/1024, packed into the bits 0 to 29.
template <class R>
struct SplitDisplacement {
    Int<R> x, y, z, remainder;
};
/// The remainder of a split displacement as a vector [units]
template <class R>
HILDA_HD inline Vec<R> unpack_remainder(const Int<R>& remainder)
{
    const auto part = [](const Int<R>& bits) { return R(0x1p-10f) * to_float(bits >> 22); };
    return {part(remainder << 22), part(remainder << 12), part(remainder << 2)};
}
/// Splits a displacement [units]. `dither`/1024 is added to the remainder before it is rounded to a
/// multiple of 1/1024. `dither` is uniformly distributed in (-1/2, 1/2), so that a small constant velocity
/// is not lost.
template <class R>
HILDA_HD inline SplitDisplacement<R> split_displacement(const Vec<R>& displacement, float dither)
{
    const auto split = [&](const R& all, Int<R>& units) {
        const R whole = rint(all);
        const Int<R> parts = to_int(rint(R(0x1p10f) * (all - whole) + R(dither)));
        units = to_int(whole) + ((parts + 512) >> 10);  // the stored part lies in [-512, 511]
        return parts & 1023;
    };
    SplitDisplacement<R> out;
    const Int<R> x = split(displacement.x, out.x), y = split(displacement.y, out.y),
                 z = split(displacement.z, out.z);
    out.remainder = x | (y << 10) | (z << 20);
    return out;
}

/// Regular cell grid over a box-shaped domain. A cell is at least as wide as the diameter of the largest
/// small particle plus the skin, so that interacting small particles lie in the same cell or in adjacent
/// cells; see Domain::small.
struct CellGrid {
    static constexpr int bits_x = 11, bits_y = 11, bits_z = 10;
    static constexpr std::int32_t widest = 1 << 29;  ///< width of the widest cell [units]

    double low[3] = {0, 0, 0};                         ///< low corner of the domain [m]
    double unit = 1;                                   ///< length unit of local coordinates [m]
    std::int32_t cells[3] = {1, 1, 1};                 ///< number of cells along each axis
    std::int32_t width[3] = {widest, widest, widest};  ///< width of a cell along each axis [units]
    /// Width of the part of the last cell that is in the domain [units]
    std::int32_t last[3] = {widest, widest, widest};
    std::int32_t periodic[3] = {0, 0, 0};  ///< 1 along a periodic axis

    /// Cell indices packed into 11, 11 and 10 bits
    HILDA_HD static std::uint32_t pack(std::uint32_t x, std::uint32_t y, std::uint32_t z)
    {
        return x | y << bits_x | z << (bits_x + bits_y);
    }
    HILDA_HD static std::int32_t x_of(std::uint32_t cell) { return cell & ((1u << bits_x) - 1); }
    HILDA_HD static std::int32_t y_of(std::uint32_t cell) { return cell >> bits_x & ((1u << bits_y) - 1); }
    HILDA_HD static std::int32_t z_of(std::uint32_t cell) { return cell >> (bits_x + bits_y); }
};

/// Difference of the positions i - j along one axis [units]; the minimum image along a periodic axis. cell_i,
/// cell_j: cell indices along the axis; i, j: local coordinates [units].
///
/// The arithmetic is modulo 2^32. The result is exact if the difference is below 2^31 units in magnitude,
/// which is at least four cell widths. An overflow of an intermediate result does not matter.
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

/// Difference of two positions i - j [units]
struct Difference {
    std::int32_t x, y, z;
};
HILDA_HD inline Difference difference(const CellGrid& g, const Position& i, const Position& j)
{
    return {difference(CellGrid::x_of(i.cell), CellGrid::x_of(j.cell), i.x, j.x, g, 0),
            difference(CellGrid::y_of(i.cell), CellGrid::y_of(j.cell), i.y, j.y, g, 1),
            difference(CellGrid::z_of(i.cell), CellGrid::z_of(j.cell), i.z, j.z, g, 2)};
}

/// Position in the global frame [m]
HILDA_HD inline Vec<double> global_position(const CellGrid& g, const Position& p)
{
    return {g.low[0] + (static_cast<double>(CellGrid::x_of(p.cell)) * g.width[0] + p.x) * g.unit,
            g.low[1] + (static_cast<double>(CellGrid::y_of(p.cell)) * g.width[1] + p.y) * g.unit,
            g.low[2] + (static_cast<double>(CellGrid::z_of(p.cell)) * g.width[2] + p.z) * g.unit};
}

/// The radius [units], truncated to an integer. Both particles of a pair use this value, so that the
/// overlap is the same for both.
HILDA_HD inline std::int32_t radius_in_units(float radius, float units_per_metre)
{
    return static_cast<std::int32_t>(radius * units_per_metre);
}

}  // namespace hilda::granular
