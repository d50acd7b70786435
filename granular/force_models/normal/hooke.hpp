// SPDX-License-Identifier: GPL-3.0-or-later
/// Linear spring and dashpot.                                                           Fang (2022), Eq. 2.41

#pragma once

#include "granular/core/contact_point.hpp"
#include "granular/core/material.hpp"

#include <cmath>

namespace hilda::granular {

///     F = k_n δ + γ_n m* δ̇
///
/// γ_n is a rate; the damping constant of Eq. 2.41 is γ_n m*. With a coefficient of restitution e it is
/// c √(m* k_n) instead, for which every collision that ends at δ = 0 has this e:
///
///     c = -2 ln e/√(π² + ln² e)
struct Hooke {
    static constexpr const char* name = "hooke";
    static constexpr const char* description =
        "Linear spring and damper (Fang 2022, Eq. 2.41): F = k_n delta + gamma_n m* deltadot. With the key "
        "restitution the damping constant is that of the coefficient of restitution, for all masses.";
    static constexpr const char* example = R"("k_n": 1e4, "gamma_n": 10)";

    float k_n = 0;      ///< [N/m]
    float gamma_n = 0;  ///< [1/s]
    int clamped = 0;    ///< 1: no tensile force
    float c = 0;        ///< damping coefficient [-]

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R damping = gamma_n * contact.m_eff + c * sqrt(contact.m_eff * R(k_n));
        const R F = k_n * contact.delta + damping * contact.v_n;
        return {clamped != 0 ? larger(F, R(0.f)) : F, R(1.f)};
    }

    /// Elastic energy [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return Number<R>(0.5) * k_n * contact.delta * contact.delta;
    }

    template <class Keys>
    static Hooke read(Keys& keys)
    {
        Hooke law{.k_n = keys.positive("k_n", "Normal stiffness k_n [N/m].", 1e4),
                  .gamma_n = keys.not_negative("gamma_n", 0,
                                               "Normal damping coefficient per effective mass [1/s]. The key "
                                               "restitution of the entry may be given instead.",
                                               10),
                  .clamped = keys.flag("clamped",
                                       "If true, the normal force is never tensile. The restitution "
                                       "is then higher than the value given.")};
        if (const auto e = keys.restitution_instead_of("gamma_n"))
            law.c = float(damping(*e) / std::sqrt(5.0 / 6));
        return law;
    }
};

}  // namespace hilda::granular
