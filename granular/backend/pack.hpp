// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs of floats and integers, and the functions on them that each set of vector instructions has of its
/// own:
///
///     sqrt(a), rint(a)       as those of real.hpp
///     bits(m)                bit k of the result: lane k of the mask
///     square_low(a)          the squares of the low halves of a, which are signed 32-bit integers
///     interleaved_floats(even, odd)
///                            signed 64-bit integers, rounded to the nearest floats, as the even and the odd lanes
///     load_rows, store_rows  four words of a row of memory for each lane, transposed to four packs
///     row_of_lane, load_consecutive, store_consecutive
///                            the same for `lanes` consecutive rows of 16 bytes from an address that is aligned to
///                            64; lane k has row row_of_lane(k)
///     flags, set_flags       bytes that are 0 or 1, as bits
///     select(bits, a, b)     a in the lanes of the set bits, b in the others
///     compress, append       the lanes of the set bits, or their numbers, one after the other. They may overwrite
///                            up to `lanes` elements
///
/// All sets give the same bits.

#pragma once

#include "granular/backend/pack_types.hpp"

#if defined(__AVX512F__)
#include "granular/backend/packs/avx512.hpp"
#elif defined(__AVX2__)
#include "granular/backend/packs/avx2.hpp"
#else
#include "granular/backend/packs/sse2.hpp"
#endif

namespace hilda::granular {

#ifndef __AVX512F__  // the other sets have no stores by masks
inline void set_flags(std::uint8_t* to, unsigned bits, unsigned which)
{
    if (which == (1u << lanes) - 1) return set_flags(to, bits);
    for (; which != 0; which &= which - 1) {
        const int k = __builtin_ctz(which);
        to[k] = bits >> k & 1;
    }
}
inline void compress(double* to, const double* from, unsigned bits)
{
    for (; bits != 0; bits &= bits - 1) *to++ = from[__builtin_ctz(bits)];
}
#endif

/// The sum d² = x² + y² + z² and the difference D² - d², exact in 64-bit integers
class Squares {
public:
    Squares() = default;
    Squares(Ints x, Ints y, Ints z, Ints D)
    {
        const auto squares = [](const Wide* of, Wide& d2, Wide& q) {
            d2 = square_low(of[0]) + square_low(of[1]) + square_low(of[2]);
            q = square_low(of[3]) - d2;
        };
        const Wide even[4] = {Wide(x.v), Wide(y.v), Wide(z.v), Wide(D.v)},
                   odd[4] = {even[0] >> 32, even[1] >> 32, even[2] >> 32, even[3] >> 32};
        squares(even, even_d2, even_q), squares(odd, odd_d2, odd_q);
    }
    Pack sum() const { return interleaved_floats(even_d2, odd_d2); }
    Pack difference() const { return interleaved_floats(even_q, odd_q); }
    /// Bit k of the result: the difference of lane k is positive
    unsigned positive() const
    {
        // the signs of the negative differences
        const Wide signs = (-even_q >> 32) | (-odd_q & ~std::uint64_t{0xFFFFFFFF});
        return bits(PackMask{PackMask::V(signs)});
    }

private:
    Wide even_d2, odd_d2, even_q, odd_q;
};

/// Bit k of the result: the highest bit of word k
inline unsigned highest_bits(const std::uint32_t* words)
{
    PackMask m;
    std::memcpy(&m, words, sizeof m);
    return bits(m);
}

}  // namespace hilda::granular
