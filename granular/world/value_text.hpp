// SPDX-License-Identifier: GPL-3.0-or-later
/// Texts of values, for messages, and refusals of values of a checkpoint.

#pragma once

#include "granular/backend/finite_state.hpp"
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

/// Refuses the first element of the list that was read last which is not finite. `a`: an io::Archive
template <class Archive, class Array>
void check_vectors(const Archive& a, const Array& list, const char* what)
{
    a.check_each(
        list, std::string(what) + " must be finite", [](const Float4& x) { return finite(x); },
        [](const Float4& x) { return shown(x); });
}

}  // namespace hilda::granular::detail
