// SPDX-License-Identifier: GPL-3.0-or-later
/// Texts of values, for messages.

#pragma once

#include "granular/core/boundary.hpp"
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
/// The matrix by rows
inline std::string shown(const Inertia& J)
{
    return '(' + shown(Vec3{J.xx, J.xy, J.zx}) + ", " + shown(Vec3{J.xy, J.yy, J.yz}) + ", " +
           shown(Vec3{J.zx, J.yz, J.zz}) + ')';
}

}  // namespace hilda::granular::detail
