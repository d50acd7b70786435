// SPDX-License-Identifier: GPL-3.0-or-later
/// Attraction proportional to an area of four times that of Hertz's theory.
///                                             LIGGGHTS, manual of "cohesion sjkr2"

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F_c = k A,   A = 2 π δ (2 R*)
///
/// k: cohesion energy density [J/m³]. 2 R* is the radius of two equal spheres.
struct Sjkr2 {
    static constexpr const char* name = "sjkr2";
    static constexpr const char* description =
        "Simplified Johnson-Kendall-Roberts law with the area of the law sjkr2 of LIGGGHTS: F_c = k A, "
        "A = 4 pi R* delta.";
    static constexpr const char* example = R"("k": 1000)";

    float k = 0;  ///< [J/m³]

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& contact) const
    {
        return Number<R>(12.5663706143591729539) * k * contact.R_eff * contact.delta;
    }
    /// Energy -2 π k R* δ² [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return -Number<R>(6.28318530717958647693) * k * contact.R_eff * contact.delta * contact.delta;
    }
    template <class Keys>
    static Sjkr2 read(Keys& keys)
    {
        return {.k = keys.coefficient("k", "Cohesion energy density k [J/m^3].", 1000)};
    }
};

}  // namespace hilda::granular
