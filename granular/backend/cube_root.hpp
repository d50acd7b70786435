// SPDX-License-Identifier: GPL-3.0-or-later
/// Cube root of a number type of the force laws.

#pragma once

#include "granular/backend/real.hpp"

#include <type_traits>

namespace hilda::granular {

/// ∛x for x ≥ 0; about 2e-7 for x below 1e-20. The operations are the same for floats and packs, and their
/// results bitwise equal.
template <class R>
HILDA_HD inline R cube_root(const R& x)
{
    if constexpr (std::is_same_v<R, double>) {
        return ::cbrt(x);
    } else {
        // A third of the bit pattern is accurate to 5 %; a step of Halley's method triples the digits.
        const R a = select(x < R(1e-20f), R(1e-20f), x);
        R y = as_float(to_int(R(1.f / 3) * to_float(as_int(a))) + 709921077);
        for (int k = 0; k < 2; ++k) {
            const R y3 = y * y * y;
            y = y * ((y3 + R(2.f) * a) / (R(2.f) * y3 + a));
        }
        return y;
    }
}

}  // namespace hilda::granular
