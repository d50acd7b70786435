// SPDX-License-Identifier: GPL-3.0-or-later
/// The one check that the sizes of all surfaces need.

#pragma once

#include "lie/check.hpp"

#include <cmath>

namespace hilda::contact {

/// x, which must be positive and finite. InvalidInput otherwise.
inline double positive(const char* where, const char* what, double x)
{
    if (!(x > 0) || !std::isfinite(x))
        lie::reject(where, std::string(what) + " must be positive and finite", x);
    return x;
}

}  // namespace hilda::contact
