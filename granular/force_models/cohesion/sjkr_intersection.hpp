// SPDX-License-Identifier: GPL-3.0-or-later
/// Attraction proportional to the area of the circle in which two overlapping spheres intersect.
///                                             LIGGGHTS, cohesion_model_sjkr.h ("cohesion sjkr")

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F_c = k A,   A = π/4 (D² - d²)(d² - (R_i - R_j)²)/d²,   D = R_i + R_j,   d = D - δ
///     A = π (2 R* - δ) δ                                      against a boundary
///
/// k: cohesion energy density [J/m³]. A is 2 π R* δ for small overlaps, twice that of Sjkr.
struct SjkrIntersection {
    static constexpr const char* name = "sjkr-intersection";
    static constexpr const char* description =
        "Simplified Johnson-Kendall-Roberts law with the area of the intersection circle of the two spheres, "
        "as the law sjkr of LIGGGHTS: F_c = k A, A = 2 pi R* delta for small overlaps.";
    static constexpr const char* example = R"("k": 1000)";

    float k = 0;  ///< [J/m³]

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& contact) const
    {
        const R D = contact.R_i + contact.R_j, d = D - contact.delta, apart = contact.R_i - contact.R_j;
        const R of_spheres = Number<R>(0.25) * (D + d) * (d - apart) * (d + apart) / (d * d);
        return Number<R>(3.14159265358979323846) * k * contact.delta *
               select(contact.R_j > R(0.f), of_spheres, 2 * contact.R_eff - contact.delta);
    }
    /// Energy -k ∫ A dδ [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        const R D = contact.R_i + contact.R_j, d = D - contact.delta, apart = contact.R_i - contact.R_j;
        const R third = Number<R>(1) / 3 * contact.delta;
        const R of_spheres = Number<R>(0.25) * (D - apart * apart / d - third);
        return -Number<R>(3.14159265358979323846) * k * contact.delta * contact.delta *
               select(contact.R_j > R(0.f), of_spheres, contact.R_eff - third);
    }
    template <class Keys>
    static SjkrIntersection read(Keys& keys)
    {
        return {.k = keys.coefficient("k", "Cohesion energy density k [J/m^3].", 1000)};
    }
};

}  // namespace hilda::granular
