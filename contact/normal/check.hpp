// SPDX-License-Identifier: GPL-3.0-or-later
/// Checks of the parameters of normal laws.

#pragma once

#include "lie/check.hpp"

#include <cmath>
#include <string>

namespace hilda::contact {

/// e = 0 would require infinite damping.
constexpr double least_restitution = 1e-6;

/// lie::InvalidInput "contact::LAW: WHAT, got VALUE" if the value is invalid or not finite
inline void check_parameter(const std::string& law, const std::string& what, double value, bool valid)
{
    if (!valid || !std::isfinite(value)) lie::reject("contact::" + law, what, value);
}

inline void check_mass(const std::string& law, double m)
{
    check_parameter(law, "the mass for the damping must be positive, or 0 for the effective mass of the pair",
                    m, m >= 0);
}

}  // namespace hilda::contact
