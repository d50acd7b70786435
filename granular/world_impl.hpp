// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of World have in common.
#pragma once

#include "granular/world.hpp"

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
inline Four to_four(const Vec3& v, double w)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

}  // namespace hilda::granular::detail
