// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs of 4 floats: SSE2, which every x86-64 has

#pragma once

#include "granular/backend/pack_types.hpp"

#include <cstring>

#include <emmintrin.h>

namespace hilda::granular {

inline Pack sqrt(Pack a) { return Pack::V(_mm_sqrt_ps(__m128(a.v))); }
inline Pack rint(Pack a)
{
    // From 2^23 on a float is an integer. Below, the sum with 2^23 is rounded to an integer.
    const Pack limit(0x1p23f);
    const Ints sign = as_int(a) & static_cast<std::int32_t>(0x80000000);
    const Pack size = as_float(as_int(a) & 0x7fffffff), rounded = (size + limit) - limit;
    return select(size < limit, as_float(as_int(rounded) | sign), a);
}
inline unsigned bits(PackMask m) { return static_cast<unsigned>(_mm_movemask_ps(__m128(m.v))); }

inline Wide square_low(Wide a)
{
    // The multiplication is one of unsigned numbers.
    const __m128i sign = _mm_srai_epi32(__m128i(a), 31),
                  size = _mm_sub_epi32(_mm_xor_si128(__m128i(a), sign), sign);
    return Wide(_mm_mul_epu32(size, size));
}
// SSE2 has no conversion of vectors of 64-bit integers.
inline Pack interleaved_floats(Wide even, Wide odd)
{
    const auto high = [](Wide a) { return _mm_cvtsi128_si64(_mm_unpackhi_epi64(__m128i(a), __m128i(a))); };
    const auto low = [](Wide a) { return _mm_cvtsi128_si64(__m128i(a)); };
    return Pack::V{static_cast<float>(low(even)), static_cast<float>(low(odd)),
                   static_cast<float>(high(even)), static_cast<float>(high(odd))};
}

namespace detail {

/// Register a[r] holds four words of a row, which become lane r of the registers out; its own inverse
inline void transpose(const __m128 a[4], __m128 out[4])
{
    const __m128 low01 = _mm_unpacklo_ps(a[0], a[1]), high01 = _mm_unpackhi_ps(a[0], a[1]),
                 low23 = _mm_unpacklo_ps(a[2], a[3]), high23 = _mm_unpackhi_ps(a[2], a[3]);
    out[0] = _mm_movelh_ps(low01, low23), out[1] = _mm_movehl_ps(low23, low01);
    out[2] = _mm_movelh_ps(high01, high23), out[3] = _mm_movehl_ps(high23, high01);
}

}  // namespace detail

template <class Word, class Row, class At>
inline void load_rows(const At& at, Word out[4])
{
    static_assert(sizeof(Row) % 16 == 0);
    __m128 a[4], words[4];
    for (int r = 0; r < 4; ++r) a[r] = _mm_load_ps(reinterpret_cast<const float*>(at(r)));
    detail::transpose(a, words);
    std::memcpy(out, words, sizeof words);
}
template <class Word, class At>
inline void store_rows(const Word in[4], const At& at)
{
    __m128 words[4], a[4];
    std::memcpy(words, in, sizeof words);
    detail::transpose(words, a);
    for (int r = 0; r < 4; ++r) _mm_store_ps(reinterpret_cast<float*>(at(r)), a[r]);
}

constexpr int row_of_lane(int k) { return k; }
template <class Word, class Row>
inline void load_consecutive(const Row* from, Word out[4])
{
    static_assert(sizeof(Row) == 16);
    load_rows<Word, Row>([&](int k) { return from + k; }, out);
}
template <class Word, class Row>
inline void store_consecutive(const Word in[4], Row* to)
{
    static_assert(sizeof(Row) == 16);
    store_rows(in, [&](int k) { return to + k; });
}

inline unsigned flags(const std::uint8_t* from)
{
    std::int32_t bytes = 0;
    std::memcpy(&bytes, from, sizeof bytes);
    const __m128i zero = _mm_cmpeq_epi8(_mm_cvtsi32_si128(bytes), _mm_setzero_si128());
    return 0xFu & ~static_cast<unsigned>(_mm_movemask_epi8(zero));
}
inline void set_flags(std::uint8_t* to, unsigned bits)
{
    const std::uint32_t ones = bits * 0x00204081u & 0x01010101u;  // bit k to bit 8 k
    std::memcpy(to, &ones, sizeof ones);
}
inline Ints select(unsigned bits, Ints a, Ints b)
{
    const Ints::V each = {1, 2, 4, 8}, set = (static_cast<std::int32_t>(bits) & each) != 0;
    return {(a.v & set) | (b.v & ~set)};
}
// Each lane is written behind those of the set bits before it. A branch for each bit would cost more.
template <class Word, class T>
inline void compress(T* to, const Word& words, unsigned bits)
{
    static_assert(sizeof(T) == 4);
    for (int k = 0; k < lanes; ++k) {
        *to = words.v[k];
        to += bits >> k & 1;
    }
}
inline std::uint32_t append(std::uint32_t* to, std::uint32_t first, unsigned bits)
{
    std::uint32_t* at = to;
    for (unsigned k = 0; k < lanes; ++k) {
        *at = first + k;
        at += bits >> k & 1;
    }
    return static_cast<std::uint32_t>(at - to);
}

}  // namespace hilda::granular
