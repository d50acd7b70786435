// SPDX-License-Identifier: GPL-3.0-or-later
/// Whether the state of the particles and the contact histories is finite.

#pragma once

#include "granular/core/neighbours/neighbours.hpp"

#include <cmath>

namespace hilda::granular {

inline bool finite(const Float4& a)
{
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z) && std::isfinite(a.w);
}

/// Whether the velocities, accelerations and orientations of the particles k for which is_own(k) and the
/// histories of all contacts are finite
template <class IsOwn>
bool is_finite(const Particles<par::Cpu>& p, const Pairs<par::Cpu>& pairs, const IsOwn& is_own)
{
    const auto one = [](const par::Array<par::Cpu, Float4>& values, std::uint32_t k) {
        return values.size() == 0 || finite(values.data()[k]);
    };
    const auto vector = [](const Vec<float>& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    for (std::uint32_t k = 0; k < p.count; ++k) {
        if (!is_own(k)) continue;
        const Compensation& c = p.compensation.data()[k];
        if (!one(p.velocity, k) || !one(p.omega, k) || !vector(load_bfloat16(c.v)) ||
            !vector(load_bfloat16(c.omega)) || !one(p.acc, k) || !one(p.alpha, k) || !one(p.orientation, k) ||
            !one(p.orientation_compensation, k))
            return false;
    }
    for (std::uint32_t n = 0; n < pairs.count; ++n)
        if (pairs.in_contact.data()[n] != 0 &&
            !(one(pairs.history, n) && one(pairs.rotation_history, n) && one(pairs.internal, n)))
            return false;
    return true;
}

}  // namespace hilda::granular
