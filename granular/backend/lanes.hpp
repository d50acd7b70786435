// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads and stores rows of four words, one row per lane, as four packs (a 4 x lanes transposition).

#pragma once

#include "granular/backend/pack.hpp"

namespace hilda::granular {

namespace detail {

#ifdef __AVX512F__
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
#endif

}  // namespace detail

/// Lane k of out[w] is word w of the row at address at(k). Rows start with 16 bytes that are aligned to 16.
template <class Word, class Row, class At>
inline void load_rows(const At& at, Word out[4])
{
    static_assert(sizeof(Row) % 16 == 0 && sizeof(Word) == 4 * lanes);
#ifdef __AVX512F__
    __m512i words[4];
    detail::load_transposed([&](int k) { return reinterpret_cast<const __m128i*>(at(k)); }, words);
    std::memcpy(out, words, sizeof words);
#else
    float words[4][lanes];
    for (int k = 0; k < lanes; ++k) {
        float row[4];
        std::memcpy(row, at(k), sizeof row);
        for (int w = 0; w < 4; ++w) words[w][k] = row[w];
    }
    std::memcpy(out, words, sizeof words);
#endif
}

/// Stores lane k of in[w] as word w of the row at address at(k), in the order of k.
template <class Word, class At>
inline void store_rows(const Word in[4], const At& at)
{
    static_assert(sizeof(Word) == 4 * lanes);
#ifdef __AVX512F__
    __m512i words[4];
    std::memcpy(words, in, sizeof words);
    detail::store_transposed(words, [&](int k) { return reinterpret_cast<__m128i*>(at(k)); });
#else
    float words[4][lanes];
    std::memcpy(words, in, sizeof words);
    for (int k = 0; k < lanes; ++k) {
        const float row[4] = {words[0][k], words[1][k], words[2][k], words[3][k]};
        std::memcpy(at(k), row, sizeof row);
    }
#endif
}

/// The row of a pack of consecutive rows that is in lane k; see load_consecutive
constexpr int row_of_lane(int k)
{
#ifdef __AVX512F__
    return k % 4 * 4 + k / 4;
#else
    return k;
#endif
}

/// Four words of `lanes` consecutive rows of 16 bytes; lane k has the row row_of_lane(k). Faster than
/// load_rows. from is aligned to 64.
template <class Word, class Row>
inline void load_consecutive(const Row* from, Word out[4])
{
    static_assert(sizeof(Row) == 16 && sizeof(Word) == 4 * lanes);
#ifdef __AVX512F__
    __m512i a[4], words[4];
    for (int r = 0; r < 4; ++r) a[r] = _mm512_load_si512(from + 4 * r);
    detail::transpose(a, words);
    std::memcpy(out, words, sizeof words);
#else
    load_rows<Word, Row>([&](int k) { return from + k; }, out);
#endif
}
/// The inverse of load_consecutive
template <class Word, class Row>
inline void store_consecutive(const Word in[4], Row* to)
{
    static_assert(sizeof(Row) == 16 && sizeof(Word) == 4 * lanes);
#ifdef __AVX512F__
    __m512i words[4], a[4];
    std::memcpy(words, in, sizeof words);
    detail::transpose_back(words, a);
    for (int r = 0; r < 4; ++r) _mm512_store_si512(to + 4 * r, a[r]);
#else
    store_rows(in, [&](int k) { return to + k; });
#endif
}

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__)
/// Bit k of the result: flag k is not zero, k = 0 … lanes - 1
inline unsigned flags(const std::uint8_t* from)
{
    const __m128i f = _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
    return _mm_test_epi8_mask(f, f);
}
/// Sets flag k to bit k.
inline void set_flags(std::uint8_t* to, unsigned bits)
{
    const __m128i ones = _mm_and_si128(_mm_movm_epi8(static_cast<__mmask16>(bits)), _mm_set1_epi8(1));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), ones);
}
/// Sets flag k to bit k, for the set bits of `which`.
inline void set_flags(std::uint8_t* to, unsigned bits, unsigned which)
{
    const __m128i ones = _mm_and_si128(_mm_movm_epi8(static_cast<__mmask16>(bits)), _mm_set1_epi8(1));
    _mm_mask_storeu_epi8(to, static_cast<__mmask16>(which), ones);
}
/// a in the lanes of the set bits, b in the others
inline Ints select(unsigned bits, Ints a, Ints b)
{
    return {Ints::V(_mm512_mask_blend_epi32(static_cast<__mmask16>(bits), __m512i(b.v), __m512i(a.v)))};
}
/// Writes the words of the lanes of the set bits. It may overwrite up to `lanes` elements of `to`.
template <class Word, class T>
inline void compress(T* to, const Word& words, unsigned bits)
{
    static_assert(sizeof(T) == 4);
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), __m512i(words.v)));
}
/// The same for `lanes` numbers from `from` on
inline void compress(double* to, const double* from, unsigned bits)
{
    const __m512d low = _mm512_loadu_pd(from), high = _mm512_loadu_pd(from + 8);
    _mm512_storeu_pd(to, _mm512_maskz_compress_pd(static_cast<__mmask8>(bits), low));
    _mm512_storeu_pd(to + __builtin_popcount(bits & 0xFF),
                     _mm512_maskz_compress_pd(static_cast<__mmask8>(bits >> 8), high));
}
/// Writes first + k for each set bit k; returns their number. It may overwrite up to `lanes` elements of
/// `to`.
inline std::uint32_t append(std::uint32_t* to, std::uint32_t first, unsigned bits)
{
    const __m512i numbers =
        _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                         _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), numbers));
    return static_cast<std::uint32_t>(__builtin_popcount(bits));
}
#else
inline unsigned flags(const std::uint8_t* from)
{
    unsigned bits = 0;
    for (int k = 0; k < lanes; ++k) bits |= (from[k] != 0 ? 1u : 0u) << k;
    return bits;
}
inline void set_flags(std::uint8_t* to, unsigned bits)
{
    for (int k = 0; k < lanes; ++k) to[k] = bits >> k & 1;
}
inline void set_flags(std::uint8_t* to, unsigned bits, unsigned which)
{
    for (int k = 0; k < lanes; ++k)
        if ((which >> k & 1) != 0) to[k] = bits >> k & 1;
}
inline Ints select(unsigned bits, Ints a, Ints b)
{
    for (int k = 0; k < lanes; ++k)
        if ((bits >> k & 1) == 0) a.v[k] = b.v[k];
    return a;
}
template <class Word, class T>
inline void compress(T* to, const Word& words, unsigned bits)
{
    for (; bits != 0; bits &= bits - 1) *to++ = words.v[__builtin_ctz(bits)];
}
inline void compress(double* to, const double* from, unsigned bits)
{
    for (; bits != 0; bits &= bits - 1) *to++ = from[__builtin_ctz(bits)];
}
inline std::uint32_t append(std::uint32_t* to, std::uint32_t first, unsigned bits)
{
    std::uint32_t n = 0;
    for (; bits != 0; bits &= bits - 1) to[n++] = first + static_cast<std::uint32_t>(__builtin_ctz(bits));
    return n;
}
#endif

/// Bit k of the result: the highest bit of word k
inline unsigned highest_bits(const std::uint32_t* words)
{
    PackMask m;
    std::memcpy(&m, words, sizeof m);
    return bits(m);
}

}  // namespace hilda::granular
