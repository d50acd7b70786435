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

class Squares {
public:
    Squares() = default;
    Squares(Ints x, Ints y, Ints z, Ints D)
    {
        // The multiplication is one of unsigned numbers. It reads the even lanes; the odd ones are shifted
        // into them.
        const auto squares = [](const auto& of, __m128i& d2, __m128i& q) {
            const auto square = [](__m128i a) { return _mm_mul_epu32(a, a); };
            d2 = _mm_add_epi64(_mm_add_epi64(square(of[0]), square(of[1])), square(of[2]));
            q = _mm_sub_epi64(square(of[3]), d2);
        };
        const auto size = [](Ints a) {
            const __m128i sign = _mm_srai_epi32(__m128i(a.v), 31);
            return _mm_sub_epi32(_mm_xor_si128(__m128i(a.v), sign), sign);
        };
        const __m128i even[4] = {size(x), size(y), size(z), size(D)};
        __m128i odd[4];
        for (int k = 0; k < 4; ++k) odd[k] = _mm_srli_epi64(even[k], 32);
        squares(even, even_d2, even_q), squares(odd, odd_d2, odd_q);
    }
    Pack sum() const { return merged(even_d2, odd_d2); }
    Pack difference() const { return merged(even_q, odd_q); }
    /// Bit k of the result: the difference of lane k is positive
    unsigned positive() const
    {
        const __m128i zero = _mm_setzero_si128(), even = _mm_sub_epi64(zero, even_q),
                      odd = _mm_sub_epi64(zero, odd_q), high = _mm_setr_epi32(0, -1, 0, -1);
        return bits(PackMask{PackMask::V(_mm_or_si128(_mm_srli_epi64(even, 32), _mm_and_si128(odd, high)))});
    }

private:
    // SSE2 has no conversion of vectors of 64-bit integers.
    static Pack merged(__m128i even, __m128i odd)
    {
        const auto high = [](__m128i a) { return _mm_cvtsi128_si64(_mm_unpackhi_epi64(a, a)); };
        const auto low = [](__m128i a) { return _mm_cvtsi128_si64(a); };
        return Pack::V{static_cast<float>(low(even)), static_cast<float>(low(odd)),
                       static_cast<float>(high(even)), static_cast<float>(high(odd))};
    }
    __m128i even_d2, odd_d2, even_q, odd_q;
};

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
inline void set_flags(std::uint8_t* to, unsigned bits, unsigned which)
{
    if (which == 0xF) return set_flags(to, bits);
    for (; which != 0; which &= which - 1) {
        const int k = __builtin_ctz(which);
        to[k] = bits >> k & 1;
    }
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
inline void compress(double* to, const double* from, unsigned bits)
{
    for (; bits != 0; bits &= bits - 1) *to++ = from[__builtin_ctz(bits)];
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
