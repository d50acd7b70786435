// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of World have in common.
#pragma once

#include "granular/world/world.hpp"

#include <cmath>
#include <sstream>

namespace hilda::granular::detail {

inline std::string name_of(std::uint32_t id) { return "particle " + std::to_string(id); }

/// Schemes that want the accelerations of the step before
inline bool keeps_accelerations(Scheme s) { return s == Scheme::chung || s == Scheme::velocity_verlet; }

template <class Value>
[[noreturn]] void refuse(const std::string& where, const std::string& what, const Value& value)
{
    std::ostringstream text;
    text.precision(9);
    text << where << ": " << what << ", got " << value;
    throw InvalidCase(text.str());
}

inline bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

inline double sphere_mass(double radius, double density)
{
    return 4.0 / 3 * M_PI * radius * radius * radius * density;
}

inline Vec3 to_double(const Four& v) { return {v.x, v.y, v.z}; }
inline Vec3 to_double(const Vec<float>& v) { return {v.x, v.y, v.z}; }
/// From the centre of j to that of i [m]
inline Vec3 apart_of(const CellGrid& g, const Position& i, const Position& j)
{
    const Difference d = difference(g, i, j);
    return g.unit * Vec3{double(d.x), double(d.y), double(d.z)};
}
/// What single precision leaves of x. Written to memory on the way: GCC 12 with -O3 and AVX takes a row of such numbers to
/// single precision and back as if nothing had happened.
inline float left_of(double x)
{
    const volatile float near = static_cast<float>(x);
    return static_cast<float>(x - near);
}
inline Vec<float> left_of(const Vec3& v) { return {left_of(v.x), left_of(v.y), left_of(v.z)}; }
inline double length(const std::array<double, 4>& e)
{
    return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
}
inline std::array<double, 4> unit(const std::array<double, 4>& e)
{
    const double l = length(e);
    return {e[0] / l, e[1] / l, e[2] / l, e[3] / l};
}
inline Four to_four(const Vec3& v, double w)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

}  // namespace hilda::granular::detail
