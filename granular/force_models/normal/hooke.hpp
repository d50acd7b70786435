// SPDX-License-Identifier: GPL-3.0-or-later
/// A linear spring and dashpot.                                                             Fang (2022), Eq. 2.41

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F = k_n δ + γ_n m* δ̇
struct Hooke {
    static constexpr const char* name = "hooke";

    float k_n = 0;      ///< [N/m]
    float gamma_n = 0;  ///< [1/s]
    int clamped = 0;    ///< no tension

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& t) const
    {
        const R F = k_n * t.delta + gamma_n * t.m_eff * t.v_n;
        return {clamped != 0 ? larger(F, R(0.f)) : F, R(1.f)};
    }

    template <class Keys>
    static Hooke read(Keys& keys)
    {
        return {.k_n = keys.positive("k_n"),
                .gamma_n = keys.not_negative("gamma_n"),
                .clamped = keys.flag("clamped")};
    }
};

}  // namespace hilda::granular
