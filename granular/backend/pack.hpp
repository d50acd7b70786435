// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs: floats and integers in the vector registers of a CPU. All operations are elementwise, so that a
/// result does not depend on the lane in which it is computed.

#pragma once

#ifdef __CUDACC__
#error "pack.hpp is for code of the CPU only"
#endif

#include "granular/backend/par.hpp"

#include <cstring>

#ifdef __AVX512F__
#include <immintrin.h>
#else
#include <emmintrin.h>
#endif

namespace hilda::granular {

#ifdef __AVX512F__
constexpr int lanes = 16;
#else
constexpr int lanes = 8;
#endif

/// Result of a comparison of packs: in each lane all bits are set or none
struct PackMask {
    using V __attribute__((vector_size(4 * lanes))) = std::int32_t;
    V v;

    PackMask operator&(const PackMask& o) const { return {v & o.v}; }
    PackMask operator|(const PackMask& o) const { return {v | o.v}; }
    PackMask operator~() const { return {~v}; }
};

/// 32-bit integers. Sums wrap: the particles of a run that diverges may move by more than 2³¹ units in the
/// step after which it is stopped.
struct Ints {
    using V __attribute__((vector_size(4 * lanes))) = std::int32_t;
    using Unsigned __attribute__((vector_size(4 * lanes))) = std::uint32_t;
    V v;

    Ints operator<<(int n) const { return {v << n}; }
    Ints operator>>(int n) const { return {v >> n}; }
    Ints operator|(Ints o) const { return {v | o.v}; }
    Ints operator&(std::int32_t o) const { return {v & o}; }
    Ints operator+(std::int32_t o) const { return *this + Ints{o - V{}}; }
    Ints operator+(Ints o) const
    {
        return {reinterpret_cast<V>(reinterpret_cast<Unsigned>(v) + reinterpret_cast<Unsigned>(o.v))};
    }
};

/// Single-precision numbers
struct Pack {
    using V __attribute__((vector_size(4 * lanes))) = float;
    V v;

    Pack() = default;
    Pack(V v) : v(v) {}
    Pack(float value) : v(value - V{}) {}

    friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
    friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
    friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
    friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
    Pack operator-() const { return -v; }
    Pack& operator+=(Pack o) { return *this = *this + o; }
    Pack& operator-=(Pack o) { return *this = *this - o; }
    Pack& operator*=(Pack o) { return *this = *this * o; }
    friend PackMask operator<(Pack a, Pack b) { return {a.v < b.v}; }
    friend PackMask operator>(Pack a, Pack b) { return {a.v > b.v}; }
    friend PackMask operator<=(Pack a, Pack b) { return {a.v <= b.v}; }
    friend PackMask operator>=(Pack a, Pack b) { return {a.v >= b.v}; }
};

template <>
struct RealType<Pack> {
    using Number = float;
    using Mask = PackMask;
    using Int = Ints;
};

inline Pack select(PackMask m, Pack a, Pack b) { return m.v ? a.v : b.v; }
inline Pack abs(Pack a) { return select(PackMask{a.v < 0}, -a, a); }
#ifdef __AVX512F__
inline Pack sqrt(Pack a) { return Pack::V(_mm512_sqrt_ps(__m512(a.v))); }
/// Bit k of the result: lane k of the mask
inline unsigned bits(PackMask m) { return _mm512_movepi32_mask(__m512i(m.v)); }
#else
inline Pack sqrt(Pack a)
{
    __m128 part[lanes / 4];
    std::memcpy(part, &a.v, sizeof part);
    for (__m128& p : part) p = _mm_sqrt_ps(p);
    std::memcpy(&a.v, part, sizeof part);
    return a;
}
inline unsigned bits(PackMask m)
{
    __m128 part[lanes / 4];
    std::memcpy(part, &m.v, sizeof part);
    unsigned out = 0;
    for (int k = 0; k < lanes / 4; ++k) out |= unsigned(_mm_movemask_ps(part[k])) << 4 * k;
    return out;
}
#endif

inline Pack to_float(Ints a) { return __builtin_convertvector(a.v, Pack::V); }
inline Ints to_int(Pack a) { return {__builtin_convertvector(a.v, Ints::V)}; }
inline Ints as_int(Pack a) { return {Ints::V(a.v)}; }
inline Pack as_float(Ints bits) { return Pack::V(bits.v); }

/// The sum d² = x² + y² + z² and the difference D² - d², exact in 64-bit integers
class Squares {
public:
    Squares() = default;
#ifdef __AVX512DQ__
    Squares(Ints x, Ints y, Ints z, Ints D)
    {
        // The multiplication reads the even lanes; the odd ones are shifted into them.
        const auto squares = [](const auto& of, __m512i& d2, __m512i& q) {
            const auto square = [](__m512i a) { return _mm512_mul_epi32(a, a); };
            d2 = _mm512_add_epi64(_mm512_add_epi64(square(of[0]), square(of[1])), square(of[2]));
            q = _mm512_sub_epi64(square(of[3]), d2);
        };
        const __m512i even[4] = {__m512i(x.v), __m512i(y.v), __m512i(z.v), __m512i(D.v)};
        __m512i odd[4];
        for (int k = 0; k < 4; ++k) odd[k] = _mm512_srli_epi64(even[k], 32);
        squares(even, even_d2, even_q), squares(odd, odd_d2, odd_q);
    }
    Pack sum() const { return merged(even_d2, odd_d2); }
    Pack difference() const { return merged(even_q, odd_q); }
    /// Bit k of the result: the difference of lane k is positive
    unsigned positive() const
    {
        const __m512i zero = _mm512_setzero_si512(), even = _mm512_sub_epi64(zero, even_q),
                      odd = _mm512_sub_epi64(zero, odd_q);
        return _mm512_movepi32_mask(_mm512_mask_blend_epi32(0xAAAA, _mm512_srli_epi64(even, 32), odd));
    }

private:
    static Pack merged(__m512i even, __m512i odd)
    {
        const auto wide = [](__m512i a) {
            return _mm512_cvtepu32_epi64(_mm256_castps_si256(_mm512_cvtepi64_ps(a)));
        };
        return Pack::V(_mm512_or_si512(wide(even), _mm512_slli_epi64(wide(odd), 32)));
    }
    __m512i even_d2, odd_d2, even_q, odd_q;
#else
    Squares(Ints x, Ints y, Ints z, Ints D)
    {
        const auto square = [](Ints a) {
            const V wide = __builtin_convertvector(a.v, V);
            return wide * wide;
        };
        d2 = square(x) + square(y) + square(z);
        q = square(D) - d2;
    }
    Pack sum() const { return __builtin_convertvector(d2, Pack::V); }
    Pack difference() const { return __builtin_convertvector(q, Pack::V); }
    unsigned positive() const { return bits(PackMask{__builtin_convertvector(q > 0, Ints::V)}); }

private:
    using V __attribute__((vector_size(8 * lanes))) = std::int64_t;
    V d2, q;
#endif
};

/// Rounds to the nearest integer. The magnitude must be below 2^31.
inline Pack rint(Pack a)
{
#ifdef __AVX512F__
    return Pack::V(_mm512_roundscale_ps(__m512(a.v), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
#else
    for (int k = 0; k < lanes; ++k) a.v[k] = ::rintf(a.v[k]);
    return a;
#endif
}

/// Maximum of the lanes; NaN if one is NaN
inline float largest(Pack a)
{
    float maximum = a.v[0];
    for (int k = 1; k < lanes; ++k) maximum = par::nan_max(maximum, a.v[k]);
    return maximum;
}

/// The two bfloat16 numbers of a word as floats, and a word of the upper halves of two words; see
/// Compensation
inline Pack low(Ints words) { return as_float(words << 16); }
inline Pack high(Ints words) { return as_float(words & static_cast<std::int32_t>(0xFFFF0000)); }
inline Ints halves(Ints low, Ints high)
{
    using Words __attribute__((vector_size(4 * lanes))) = std::uint32_t;
    return {Ints::V((Words(low.v) >> 16) | Words(high.v))};
}

}  // namespace hilda::granular
