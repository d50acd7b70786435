// SPDX-License-Identifier: GPL-3.0-or-later
/// Validation of lengths in the constructors of surfaces.

#pragma once

#include "lie/check.hpp"
#include "lie/so3.hpp"

#include <cmath>

namespace hilda::contact {

/// Returns x. InvalidInput unless it is positive and finite; the message starts with "where: what must be".
inline double positive(const char* where, const char* what, double x)
{
    if (!(x > 0) || !std::isfinite(x))
        lie::reject(where, std::string(what) + " must be positive and finite", x);
    return x;
}

/// The same for each component of a vector, as the semi-axes of an ellipsoid
inline const lie::Vec3& positive(const char* where, const char* what, const lie::Vec3& x)
{
    for (const double component : {x.x(), x.y(), x.z()}) positive(where, what, component);
    return x;
}

}  // namespace hilda::contact
