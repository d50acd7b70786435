// SPDX-License-Identifier: GPL-3.0-or-later
/// Attraction proportional to the contact area: the simplified Johnson-Kendall-Roberts law (SJKR).

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F_c = k A,   A = π a² = π R* δ
///
/// k: cohesion energy density [J/m³]. A is the contact area of Hertz's theory. See SjkrIntersection and
/// Sjkr2 for the areas of LIGGGHTS, which are twice and four times as large.
struct Sjkr {
    static constexpr const char* name = "sjkr";
    static constexpr const char* description =
        "Simplified Johnson-Kendall-Roberts law: F_c = k A with the contact area A = pi R* delta of Hertz's "
        "theory. It is half of the law sjkr of LIGGGHTS, which is sjkr-intersection here.";
    static constexpr const char* example = R"("k": 1000)";

    float k = 0;  ///< [J/m³]

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& contact) const
    {
        return Number<R>(3.14159265358979323846) * k * contact.R_eff * contact.delta;
    }
    /// Energy -π/2 k R* δ² [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return -Number<R>(1.57079632679489661923) * k * contact.R_eff * contact.delta * contact.delta;
    }
    template <class Keys>
    static Sjkr read(Keys& keys)
    {
        return {.k = keys.coefficient("k", "Cohesion energy density k [J/m^3].", 1000)};
    }
};

}  // namespace hilda::granular
