// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs of 8 floats: AVX2 (x86-64-v3)

#pragma once

#include "granular/backend/pack_types.hpp"

#include <cstring>

#include <immintrin.h>

namespace hilda::granular {

inline Pack sqrt(Pack a) { return Pack::V(_mm256_sqrt_ps(__m256(a.v))); }
inline Pack rint(Pack a)
{
    return Pack::V(_mm256_round_ps(__m256(a.v), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
}
inline unsigned bits(PackMask m) { return static_cast<unsigned>(_mm256_movemask_ps(__m256(m.v))); }

inline Wide square_low(Wide a) { return Wide(_mm256_mul_epi32(__m256i(a), __m256i(a))); }
// AVX2 has no conversion of vectors of 64-bit integers.
inline Pack interleaved_floats(Wide even, Wide odd)
{
    alignas(32) std::int64_t e[4], o[4];
    std::memcpy(e, &even, sizeof e), std::memcpy(o, &odd, sizeof o);
    Pack out;
    for (int k = 0; k < 4; ++k)
        out.v[2 * k] = static_cast<float>(e[k]), out.v[2 * k + 1] = static_cast<float>(o[k]);
    return out;
}

namespace detail {

/// Half q of register a[r] holds four words of a row, which become lane 4 q + r of the registers out; its own
/// inverse
inline void transpose(const __m256 a[4], __m256 out[4])
{
    const __m256d low01 = _mm256_castps_pd(_mm256_unpacklo_ps(a[0], a[1])),
                  high01 = _mm256_castps_pd(_mm256_unpackhi_ps(a[0], a[1])),
                  low23 = _mm256_castps_pd(_mm256_unpacklo_ps(a[2], a[3])),
                  high23 = _mm256_castps_pd(_mm256_unpackhi_ps(a[2], a[3]));
    out[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(low01, low23));
    out[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(low01, low23));
    out[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(high01, high23));
    out[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(high01, high23));
}

/// lane[b]: the numbers of the set bits of b, then zeros
struct CompressTable {
    alignas(32) std::int32_t lane[256][8] = {};
    constexpr CompressTable()
    {
        for (int b = 0; b < 256; ++b)
            for (int k = 0, n = 0; k < 8; ++k)
                if ((b >> k & 1) != 0) lane[b][n++] = k;
    }
};
constexpr CompressTable compress_table;  // not inline: each set of instructions has its own
inline __m256i lanes_of(unsigned bits)
{
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(compress_table.lane[bits]));
}

}  // namespace detail

template <class Word, class Row, class At>
inline void load_rows(const At& at, Word out[4])
{
    static_assert(sizeof(Row) % 16 == 0);
    const auto row = [&](int k) { return _mm_load_ps(reinterpret_cast<const float*>(at(k))); };
    __m256 a[4], words[4];
    for (int r = 0; r < 4; ++r) a[r] = _mm256_insertf128_ps(_mm256_castps128_ps256(row(r)), row(4 + r), 1);
    detail::transpose(a, words);
    std::memcpy(out, words, sizeof words);
}
template <class Word, class At>
inline void store_rows(const Word in[4], const At& at)
{
    __m256 words[4], a[4];
    std::memcpy(words, in, sizeof words);
    detail::transpose(words, a);
    for (int r = 0; r < 4; ++r) _mm_store_ps(reinterpret_cast<float*>(at(r)), _mm256_castps256_ps128(a[r]));
    for (int r = 0; r < 4; ++r)
        _mm_store_ps(reinterpret_cast<float*>(at(4 + r)), _mm256_extractf128_ps(a[r], 1));
}

// Half q of register r holds row 2 r + q.
constexpr int row_of_lane(int k) { return k % 4 * 2 + k / 4; }
template <class Word, class Row>
inline void load_consecutive(const Row* from, Word out[4])
{
    static_assert(sizeof(Row) == 16);
    __m256 a[4], words[4];
    for (int r = 0; r < 4; ++r) a[r] = _mm256_load_ps(reinterpret_cast<const float*>(from + 2 * r));
    detail::transpose(a, words);
    std::memcpy(out, words, sizeof words);
}
template <class Word, class Row>
inline void store_consecutive(const Word in[4], Row* to)
{
    static_assert(sizeof(Row) == 16);
    __m256 words[4], a[4];
    std::memcpy(words, in, sizeof words);
    detail::transpose(words, a);
    for (int r = 0; r < 4; ++r) _mm256_store_ps(reinterpret_cast<float*>(to + 2 * r), a[r]);
}

inline unsigned flags(const std::uint8_t* from)
{
    const __m128i f = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
    return 0xFFu & ~static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(f, _mm_setzero_si128())));
}
inline void set_flags(std::uint8_t* to, unsigned bits)
{
    const __m128i each = _mm_set1_epi64x(static_cast<long long>(0x8040201008040201)),
                  of_lane = _mm_and_si128(_mm_set1_epi8(static_cast<char>(bits)), each),
                  ones = _mm_and_si128(_mm_cmpeq_epi8(of_lane, each), _mm_set1_epi8(1));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to), ones);
}
inline Ints select(unsigned bits, Ints a, Ints b)
{
    const __m256i each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i set =
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), each), each);
    return {Ints::V(_mm256_blendv_epi8(__m256i(b.v), __m256i(a.v), set))};
}
template <class Word, class T>
inline void compress(T* to, const Word& words, unsigned bits)
{
    static_assert(sizeof(T) == 4);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm256_permutevar8x32_epi32(__m256i(words.v), detail::lanes_of(bits)));
}
inline std::uint32_t append(std::uint32_t* to, std::uint32_t first, unsigned bits)
{
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(first)), detail::lanes_of(bits)));
    return static_cast<std::uint32_t>(__builtin_popcount(bits));
}

}  // namespace hilda::granular
