// SPDX-License-Identifier: GPL-3.0-or-later
/// Texts of values, for messages.

#pragma once

#include "granular/core/particles.hpp"
#include "io/json.hpp"

#include <string>

namespace hilda::granular::detail {

inline std::string shown(double x) { return io::shortest(x); }
inline std::string shown(const Vec<double>& v)
{
    return '(' + shown(v.x) + ", " + shown(v.y) + ", " + shown(v.z) + ')';
}
inline std::string shown(const Float4& a)
{
    return '(' + shown(a.x) + ", " + shown(a.y) + ", " + shown(a.z) + ", " + shown(a.w) + ')';
}

}  // namespace hilda::granular::detail
