// SPDX-License-Identifier: GPL-3.0-or-later
/// Attraction over the area of contact: the simplified law of Johnson, Kendall and Roberts.

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F_c = k A,   A = π a² = π R* δ
///
/// with an energy density k [J/m³]. The area is that of Hertz; of two equal spheres cut through it would be twice that.
struct Sjkr {
    static constexpr const char* name = "sjkr";

    float k = 0;

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& t) const
    {
        return Number<R>(3.14159265358979323846) * k * t.R_eff * t.delta;
    }
    template <class Keys>
    static Sjkr read(Keys& keys)
    {
        return {.k = keys.not_negative("k")};
    }
};

}  // namespace hilda::granular
