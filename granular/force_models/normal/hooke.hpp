// SPDX-License-Identifier: GPL-3.0-or-later
/// Linear spring and dashpot.                                                           Fang (2022), Eq. 2.41

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F = k_n δ + γ_n m* δ̇
///
/// γ_n is a rate; the damping constant of Eq. 2.41 is γ_n m*.
struct Hooke {
    static constexpr const char* name = "hooke";
    static constexpr const char* description =
        "Linear spring and damper (Fang 2022, Eq. 2.41): F = k_n delta + gamma_n m* deltadot.";
    static constexpr const char* example = R"("k_n": 1e4, "gamma_n": 10)";

    float k_n = 0;      ///< [N/m]
    float gamma_n = 0;  ///< [1/s]
    int clamped = 0;    ///< 1: no tensile force

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R F = k_n * contact.delta + gamma_n * contact.m_eff * contact.v_n;
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
        return {.k_n = keys.positive("k_n", "Normal stiffness k_n [N/m].", 1e4),
                .gamma_n = keys.not_negative("gamma_n", 0,
                                             "Normal damping coefficient per effective mass [1/s].", 10),
                .clamped = keys.flag("clamped", "If true, the normal force is never tensile.")};
    }
};

}  // namespace hilda::granular
