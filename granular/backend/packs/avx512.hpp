// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs of 16 floats: AVX-512 with the parts F, BW, CD, DQ and VL (x86-64-v4)

#pragma once

#include "granular/backend/pack_types.hpp"

#include <cstring>

#include <immintrin.h>

namespace hilda::granular {

inline Pack sqrt(Pack a) { return Pack::V(_mm512_sqrt_ps(__m512(a.v))); }
inline Pack rint(Pack a)
{
    return Pack::V(_mm512_roundscale_ps(__m512(a.v), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
}
inline unsigned bits(PackMask m) { return _mm512_movepi32_mask(__m512i(m.v)); }

inline Wide square_low(Wide a) { return Wide(_mm512_mul_epi32(__m512i(a), __m512i(a))); }
inline Pack interleaved_floats(Wide even, Wide odd)
{
    const auto wide = [](Wide a) {
        return _mm512_cvtepu32_epi64(_mm256_castps_si256(_mm512_cvtepi64_ps(__m512i(a))));
    };
    return Pack::V(_mm512_or_si512(wide(even), _mm512_slli_epi64(wide(odd), 32)));
}

namespace detail {

/// Quarter q of register a[r] holds four words of a row, which become lane 4 q + r of the registers out.
inline void transpose(const __m512i a[4], __m512i out[4])
{
    const __m512i low01 = _mm512_unpacklo_epi32(a[0], a[1]), high01 = _mm512_unpackhi_epi32(a[0], a[1]);
    const __m512i low23 = _mm512_unpacklo_epi32(a[2], a[3]), high23 = _mm512_unpackhi_epi32(a[2], a[3]);
    out[0] = _mm512_unpacklo_epi64(low01, low23), out[1] = _mm512_unpackhi_epi64(low01, low23);
    out[2] = _mm512_unpacklo_epi64(high01, high23), out[3] = _mm512_unpackhi_epi64(high01, high23);
}
/// The inverse of transpose
inline void transpose_back(const __m512i in[4], __m512i a[4])
{
    const __m512i low01 = _mm512_unpacklo_epi32(in[0], in[1]), high01 = _mm512_unpackhi_epi32(in[0], in[1]);
    const __m512i low23 = _mm512_unpacklo_epi32(in[2], in[3]), high23 = _mm512_unpackhi_epi32(in[2], in[3]);
    a[0] = _mm512_unpacklo_epi64(low01, low23), a[1] = _mm512_unpackhi_epi64(low01, low23);
    a[2] = _mm512_unpacklo_epi64(high01, high23), a[3] = _mm512_unpackhi_epi64(high01, high23);
}

/// Four words of sixteen rows as four registers; row k is at address at(k)
template <class At>
inline void load_transposed(const At& at, __m512i out[4])
{
    // quarter q of register a[r] holds row 4 q + r
    __m512i a[4];
    for (int r = 0; r < 4; ++r) {
        a[r] = _mm512_castsi128_si512(_mm_load_si128(at(r)));
        a[r] = _mm512_inserti32x4(a[r], _mm_load_si128(at(4 + r)), 1);
        a[r] = _mm512_inserti32x4(a[r], _mm_load_si128(at(8 + r)), 2);
        a[r] = _mm512_inserti32x4(a[r], _mm_load_si128(at(12 + r)), 3);
    }
    transpose(a, out);
}

/// The inverse of load_transposed
template <class At>
inline void store_transposed(const __m512i in[4], const At& at)
{
    __m512i a[4];
    transpose_back(in, a);
    for (int r = 0; r < 4; ++r) {
        _mm_store_si128(at(r), _mm512_castsi512_si128(a[r]));
        _mm_store_si128(at(4 + r), _mm512_extracti32x4_epi32(a[r], 1));
        _mm_store_si128(at(8 + r), _mm512_extracti32x4_epi32(a[r], 2));
        _mm_store_si128(at(12 + r), _mm512_extracti32x4_epi32(a[r], 3));
    }
}

}  // namespace detail

template <class Word, class Row, class At>
inline void load_rows(const At& at, Word out[4])
{
    static_assert(sizeof(Row) % 16 == 0);
    __m512i words[4];
    detail::load_transposed([&](int k) { return reinterpret_cast<const __m128i*>(at(k)); }, words);
    std::memcpy(out, words, sizeof words);
}
template <class Word, class At>
inline void store_rows(const Word in[4], const At& at)
{
    __m512i words[4];
    std::memcpy(words, in, sizeof words);
    detail::store_transposed(words, [&](int k) { return reinterpret_cast<__m128i*>(at(k)); });
}

constexpr int row_of_lane(int k) { return k % 4 * 4 + k / 4; }
template <class Word, class Row>
inline void load_consecutive(const Row* from, Word out[4])
{
    static_assert(sizeof(Row) == 16);
    __m512i a[4], words[4];
    for (int r = 0; r < 4; ++r) a[r] = _mm512_load_si512(from + 4 * r);
    detail::transpose(a, words);
    std::memcpy(out, words, sizeof words);
}
template <class Word, class Row>
inline void store_consecutive(const Word in[4], Row* to)
{
    static_assert(sizeof(Row) == 16);
    __m512i words[4], a[4];
    std::memcpy(words, in, sizeof words);
    detail::transpose_back(words, a);
    for (int r = 0; r < 4; ++r) _mm512_store_si512(to + 4 * r, a[r]);
}

inline unsigned flags(const std::uint8_t* from)
{
    const __m128i f = _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
    return _mm_test_epi8_mask(f, f);
}
inline void set_flags(std::uint8_t* to, unsigned bits)
{
    const __m128i ones = _mm_and_si128(_mm_movm_epi8(static_cast<__mmask16>(bits)), _mm_set1_epi8(1));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), ones);
}
inline void set_flags(std::uint8_t* to, unsigned bits, unsigned which)
{
    const __m128i ones = _mm_and_si128(_mm_movm_epi8(static_cast<__mmask16>(bits)), _mm_set1_epi8(1));
    _mm_mask_storeu_epi8(to, static_cast<__mmask16>(which), ones);
}
inline Ints select(unsigned bits, Ints a, Ints b)
{
    return {Ints::V(_mm512_mask_blend_epi32(static_cast<__mmask16>(bits), __m512i(b.v), __m512i(a.v)))};
}
template <class Word, class T>
inline void compress(T* to, const Word& words, unsigned bits)
{
    static_assert(sizeof(T) == 4);
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), __m512i(words.v)));
}
inline void compress(double* to, const double* from, unsigned bits)
{
    const __m512d low = _mm512_loadu_pd(from), high = _mm512_loadu_pd(from + 8);
    _mm512_storeu_pd(to, _mm512_maskz_compress_pd(static_cast<__mmask8>(bits), low));
    _mm512_storeu_pd(to + __builtin_popcount(bits & 0xFF),
                     _mm512_maskz_compress_pd(static_cast<__mmask8>(bits >> 8), high));
}
inline std::uint32_t append(std::uint32_t* to, std::uint32_t first, unsigned bits)
{
    const __m512i numbers =
        _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                         _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), numbers));
    return static_cast<std::uint32_t>(__builtin_popcount(bits));
}

}  // namespace hilda::granular
