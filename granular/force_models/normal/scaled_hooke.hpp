// SPDX-License-Identifier: GPL-3.0-or-later
/// Hertzian contact with a prescribed stiffness.                                        Fang (2022), Eq. 2.42

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F = √(δ/R) (k_n δ + γ_n m* δ̇)
///
/// R is the larger radius: R = 2 R* for equal spheres, and R = R* for a sphere and a plane. The elastic part
/// is that of Eq. 2.42 with the stiffness k_n/√R. The damping is scaled as well, as in the law of Chrono::GPU
/// for prescribed stiffnesses.
struct ScaledHooke {
    static constexpr const char* name = "scaled-hooke";
    static constexpr const char* description =
        "Linear law scaled by sqrt(delta/R), where R is the larger of the two radii (Fang 2022, "
        "Eq. 2.42): F = sqrt(delta/R) (k_n delta + gamma_n m* deltadot).";
    static constexpr const char* example = R"("k_n": 1e4, "gamma_n": 10)";

    float k_n = 0;      ///< [N/m]; F/δ at δ = R
    float gamma_n = 0;  ///< [1/s]
    int clamped = 0;    ///< 1: no tensile force

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R scale = sqrt(contact.delta / larger(contact.R_i, contact.R_j));
        const R F = scale * (k_n * contact.delta + gamma_n * contact.m_eff * contact.v_n);
        return {clamped != 0 ? larger(F, R(0.f)) : F, scale, Number<R>(0.5)};
    }

    /// Elastic energy 2/5 √(δ/R) k_n δ² [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return Number<R>(0.4) * k_n * sqrt(contact.delta / larger(contact.R_i, contact.R_j)) * contact.delta *
               contact.delta;
    }

    template <class Keys>
    static ScaledHooke read(Keys& keys)
    {
        return {.k_n = keys.positive("k_n", "Normal stiffness k_n [N/m] at delta = R.", 1e4),
                .gamma_n = keys.not_negative("gamma_n", 0,
                                             "Normal damping coefficient per effective mass [1/s].", 10),
                .clamped = keys.flag("clamped", "If true, the normal force is never tensile.")};
    }
};

}  // namespace hilda::granular
