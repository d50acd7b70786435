// SPDX-License-Identifier: GPL-3.0-or-later
/// Arithmetic of a number type R, and 3-vectors of it. The force laws and the time integration are templates
/// on R: float on a GPU, Pack in the loops of the CPU, double in DoubleWorld.

#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#ifdef __CUDACC__
#define HILDA_HD __host__ __device__
#define HILDA_ALWAYS_INLINE __forceinline__
#else
#define HILDA_HD
#define HILDA_ALWAYS_INLINE [[gnu::always_inline]] inline
#endif

namespace hilda::granular {

/// Types that belong to a number type: scalar parameter, result of a comparison, 32-bit integer
template <class R>
struct RealType {
    using Number = R;
    using Mask = bool;
    using Int = std::int32_t;
};
template <class R>
using Number = typename RealType<R>::Number;
template <class R>
using Mask = typename RealType<R>::Mask;
template <class R>
using Int = typename RealType<R>::Int;

HILDA_HD inline float sqrt(float x) { return ::sqrtf(x); }
HILDA_HD inline double sqrt(double x) { return ::sqrt(x); }
HILDA_HD inline float rint(float x) { return ::rintf(x); }
HILDA_HD inline double rint(double x) { return ::rint(x); }
HILDA_HD inline float abs(float x) { return ::fabsf(x); }
HILDA_HD inline double abs(double x) { return ::fabs(x); }
HILDA_HD inline float select(bool condition, float a, float b) { return condition ? a : b; }
HILDA_HD inline double select(bool condition, double a, double b) { return condition ? a : b; }
HILDA_HD inline float to_float(std::int32_t n) { return static_cast<float>(n); }
HILDA_HD inline std::int32_t to_int(float x) { return static_cast<std::int32_t>(x); }
HILDA_HD inline std::int32_t as_int(float x)  ///< bit pattern of a float
{
    std::int32_t n = 0;
    memcpy(&n, &x, sizeof n);
    return n;
}
/// The float with the given bit pattern
HILDA_HD inline float as_float(std::int32_t bits)
{
    float x = 0;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/// Minimum and maximum. The functions select with a < b and do not propagate NaN.
template <class R>
HILDA_HD inline R smaller(R a, R b)
{
    return select(a < b, a, b);
}
template <class R>
HILDA_HD inline R larger(R a, R b)
{
    return select(a < b, b, a);
}

/// A 3-vector
template <class R>
struct Vec {
    R x, y, z;

    HILDA_HD Vec operator+(const Vec& o) const { return {x + o.x, y + o.y, z + o.z}; }
    HILDA_HD Vec operator-(const Vec& o) const { return {x - o.x, y - o.y, z - o.z}; }
    HILDA_HD Vec operator-() const { return {-x, -y, -z}; }
    HILDA_HD Vec& operator+=(const Vec& o) { return *this = *this + o; }
    HILDA_HD Vec& operator-=(const Vec& o) { return *this = *this - o; }
    HILDA_HD friend Vec operator*(const R& s, const Vec& v) { return {s * v.x, s * v.y, s * v.z}; }
    HILDA_HD R dot(const Vec& o) const { return x * o.x + y * o.y + z * o.z; }
    HILDA_HD Vec cross(const Vec& o) const
    {
        return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x};
    }
    HILDA_HD R norm() const { return sqrt(dot(*this)); }
    bool operator==(const Vec&) const = default;
};

template <class R>
HILDA_HD inline Vec<R> select(const Mask<R>& condition, const Vec<R>& a, const Vec<R>& b)
{
    return {select(condition, a.x, b.x), select(condition, a.y, b.y), select(condition, a.z, b.z)};
}

}  // namespace hilda::granular
