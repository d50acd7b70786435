// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs of floats and integers, and the functions on them that each set of vector instructions has of its
/// own:
///
///     sqrt(a), rint(a)       as those of real.hpp
///     bits(m)                bit k of the result: lane k of the mask
///     Squares                the sum d² = x² + y² + z² and the difference D² - d², exact in 64-bit integers
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

/// Bit k of the result: the highest bit of word k
inline unsigned highest_bits(const std::uint32_t* words)
{
    PackMask m;
    std::memcpy(&m, words, sizeof m);
    return bits(m);
}

}  // namespace hilda::granular
