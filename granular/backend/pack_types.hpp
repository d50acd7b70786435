// SPDX-License-Identifier: GPL-3.0-or-later
/// Packs: floats and integers in the vector registers of a CPU. All operations are elementwise, so that a
/// result does not depend on the lane in which it is computed.

#pragma once

#ifdef __CUDACC__
#error "packs are for code of the CPU only"
#endif

#include "granular/backend/par.hpp"

namespace hilda::granular {

/// Number of floats in a pack: one vector register
#if defined(__AVX512F__)
constexpr int lanes = 16;
#elif defined(__AVX2__)
constexpr int lanes = 8;
#else
constexpr int lanes = 4;
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

/// The even or the odd lanes of a pack of integers, or what follows from them, as 64-bit integers. Sums wrap.
using Wide __attribute__((vector_size(4 * lanes))) = std::uint64_t;

inline Pack select(PackMask m, Pack a, Pack b) { return m.v ? a.v : b.v; }
inline Pack abs(Pack a) { return select(PackMask{a.v < 0}, -a, a); }

inline Pack to_float(Ints a) { return __builtin_convertvector(a.v, Pack::V); }
inline Ints to_int(Pack a) { return {__builtin_convertvector(a.v, Ints::V)}; }
inline Ints as_int(Pack a) { return {Ints::V(a.v)}; }
inline Pack as_float(Ints bits) { return Pack::V(bits.v); }

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
