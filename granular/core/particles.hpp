// SPDX-License-Identifier: GPL-3.0-or-later
/// Particle state: integer positions in a cell grid, rounding remainders.         Fang (2022), Secs. 6.1, 6.2

#pragma once

#include "granular/backend/real.hpp"

#include <cstdint>

namespace hilda::granular {

/// Position of a particle centre: integer coordinates from the low corner of the domain, modulo 2^32, and the
/// owner cell.
///
/// The difference of two neighbouring positions is an exact integer, wherever they are in the domain. The
/// owner cell is assigned at a neighbour search. Between searches only the coordinates change, and the
/// particle may leave its owner cell by less than a cell width.
struct alignas(16) Position {
    std::uint32_t cell = 0;            ///< owner cell, packed by CellGrid::pack()
    std::int32_t x = 0, y = 0, z = 0;  ///< modulo 2^32 [CellGrid::unit]
};
/// Sum and difference modulo 2^32
HILDA_HD inline std::int32_t wrapped_sum(std::int32_t a, std::int32_t b)
{
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}
HILDA_HD inline std::int32_t wrapped_difference(std::int32_t a, std::int32_t b)
{
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
HILDA_HD inline std::int32_t wrapped_product(std::int32_t a, std::int32_t b)
{
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}

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

/// Number of the clump of a particle that is in none
constexpr std::uint32_t no_clump = ~std::uint32_t{0};

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
    static constexpr int cell_bits = 32;             ///< bits of a packed cell
    static constexpr std::int32_t widest = 1 << 29;  ///< width of the widest cell [units]

    double low[3] = {0, 0, 0};                         ///< low corner of the domain [m]
    double unit = 1;                                   ///< length unit of the coordinates [m]
    std::int32_t cells[3] = {1, 1, 1};                 ///< number of cells along each axis
    std::int32_t width[3] = {widest, widest, widest};  ///< width of a cell along each axis [units]
    /// Width of the part of the last cell that is in the domain [units]
    std::int32_t last[3] = {widest, widest, widest};
    std::int32_t periodic[3] = {0, 0, 0};     ///< 1 along a periodic axis
    std::int32_t shift_y = 11, shift_z = 22;  ///< first bits of y and z in a packed cell

    /// The indices of a cell in one word: x in the lowest bits, then y, then z
    HILDA_HD std::uint32_t pack(std::uint32_t x, std::uint32_t y, std::uint32_t z) const
    {
        return x | y << shift_y | z << shift_z;
    }
    HILDA_HD std::int32_t x_of(std::uint32_t cell) const { return cell & ((1u << shift_y) - 1); }
    HILDA_HD std::int32_t y_of(std::uint32_t cell) const
    {
        return cell >> shift_y & ((1u << (shift_z - shift_y)) - 1);
    }
    HILDA_HD std::int32_t z_of(std::uint32_t cell) const { return cell >> shift_z; }

    /// Coordinate along an axis relative to the low corner of the cell with this index along it [units]
    HILDA_HD std::int32_t local(std::int32_t x, std::int32_t cell, int axis) const
    {
        return wrapped_difference(x, wrapped_product(cell, width[axis]));
    }
};

/// The periods by which the minimum image of j is moved along an axis; 0 along an axis that is not periodic.
/// cell_i, cell_j: cell indices along the axis.
HILDA_HD HILDA_ALWAYS_INLINE std::int32_t nearest_period(std::int32_t cell_i, std::int32_t cell_j,
                                                         const CellGrid& g, int axis)
{
    const std::int32_t d = cell_i - cell_j, n = g.cells[axis];
    if (g.periodic[axis] == 0 || (2 * d <= n && 2 * d >= -n)) return 0;
    return d > 0 ? 1 : -1;
}

/// Difference of the coordinates i - j along one axis [units], with j moved by a number of periods
///
/// The arithmetic is modulo 2^32. The result is exact if the difference is below 2^31 units in magnitude,
/// which is at least four cell widths.
HILDA_HD HILDA_ALWAYS_INLINE std::int32_t difference(std::int32_t i, std::int32_t j, std::int32_t periods,
                                                     const CellGrid& g, int axis)
{
    const std::int32_t d = wrapped_difference(i, j);
    if (periods == 0) return d;
    return wrapped_difference(d, wrapped_product(periods, wrapped_product(g.cells[axis], g.width[axis])));
}

/// Difference of two positions i - j [units]
struct Difference {
    std::int32_t x, y, z;
};
HILDA_HD HILDA_ALWAYS_INLINE Difference difference(const CellGrid& g, const Position& i, const Position& j)
{
    return {difference(i.x, j.x, nearest_period(g.x_of(i.cell), g.x_of(j.cell), g, 0), g, 0),
            difference(i.y, j.y, nearest_period(g.y_of(i.cell), g.y_of(j.cell), g, 1), g, 1),
            difference(i.z, j.z, nearest_period(g.z_of(i.cell), g.z_of(j.cell), g, 2), g, 2)};
}

/// A periodic image of particle j in a pair: j moved by (x, y, z) periods, each -1, 0 or 1, in one byte
struct Image {
    static constexpr std::uint8_t none = 13;  ///< j itself

    HILDA_HD static std::uint8_t pack(std::int32_t x, std::int32_t y, std::int32_t z)
    {
        return static_cast<std::uint8_t>(none + x + 3 * y + 9 * z);
    }
    HILDA_HD static std::int32_t x_of(std::uint8_t image) { return image % 3 - 1; }
    HILDA_HD static std::int32_t y_of(std::uint8_t image) { return image / 3 % 3 - 1; }
    HILDA_HD static std::int32_t z_of(std::uint8_t image) { return image / 9 - 1; }
};
/// Difference of two positions, i minus this image of j [units]
HILDA_HD inline Difference difference(const CellGrid& g, const Position& i, const Position& j,
                                      std::uint8_t image)
{
    return {difference(i.x, j.x, Image::x_of(image), g, 0), difference(i.y, j.y, Image::y_of(image), g, 1),
            difference(i.z, j.z, Image::z_of(image), g, 2)};
}

/// Position in the global frame [m]
HILDA_HD inline Vec<double> global_position(const CellGrid& g, const Position& p)
{
    const auto coordinate = [&](std::int32_t x, std::int32_t cell, int axis) {
        return g.low[axis] + (static_cast<double>(cell) * g.width[axis] + g.local(x, cell, axis)) * g.unit;
    };
    return {coordinate(p.x, g.x_of(p.cell), 0), coordinate(p.y, g.y_of(p.cell), 1),
            coordinate(p.z, g.z_of(p.cell), 2)};
}

/// The radius [units], truncated to an integer. Both particles of a pair use this value, so that the
/// overlap is the same for both.
HILDA_HD inline std::int32_t radius_in_units(float radius, float units_per_metre)
{
    return static_cast<std::int32_t>(radius * units_per_metre);
}

}  // namespace hilda::granular
