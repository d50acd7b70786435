// SPDX-License-Identifier: GPL-3.0-or-later
/// Validation of lengths in the constructors of surfaces.

#pragma once

#include "lie/check.hpp"

#include <cmath>

namespace hilda::contact {

/// Returns x. InvalidInput unless it is positive and finite; the message starts with "where: what must be".
inline double positive(const char* where, const char* what, double x)
{
    if (!(x > 0) || !std::isfinite(x))
        lie::reject(where, std::string(what) + " must be positive and finite", x);
    return x;
}

}  // namespace hilda::contact
