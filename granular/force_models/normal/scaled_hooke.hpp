// SPDX-License-Identifier: GPL-3.0-or-later
/// Hertz's exponent with a stiffness that is given.                                         Fang (2022), Eq. 2.42

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F = √(δ/R) (k_n δ + γ_n m* δ̇)
///
/// R is the radius for equal spheres and for a sphere on a wall: 2 R* and R*.
struct ScaledHooke {
    static constexpr const char* name = "scaled-hooke";

    float k_n = 0;      ///< [N/m]: the stiffness where δ is R
    float gamma_n = 0;  ///< [1/s]
    int clamped = 0;    ///< no tension

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& t) const
    {
        const R scale = sqrt(t.delta / larger(t.R_i, t.R_j));
        const R F = scale * (k_n * t.delta + gamma_n * t.m_eff * t.v_n);
        return {clamped != 0 ? larger(F, R(0.f)) : F, scale, Number<R>(0.5)};
    }

    template <class Keys>
    static ScaledHooke read(Keys& keys)
    {
        return {.k_n = keys.positive("k_n"),
                .gamma_n = keys.not_negative("gamma_n"),
                .clamped = keys.flag("clamped")};
    }
};

}  // namespace hilda::granular
