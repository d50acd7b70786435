// SPDX-License-Identifier: GPL-3.0-or-later
/// Viscoelastic spheres.                                Kuwabara and Kono, Jpn. J. Appl. Phys. 26 (1987)
///
/// Brilliantov, Spahn, Hertzsch and Pöschel, Phys. Rev. E 53 (1996), derive the same law and define A.

#pragma once

#include "granular/core/contact_point.hpp"
#include "granular/core/material.hpp"

#include <cmath>

namespace hilda::granular {

///     F = k (δ^(3/2) + 3/2 A √δ δ̇) = 2/3 S δ + A S δ̇,    k = 4/3 E* √R*,  S = 2 E* √(R* δ)
///
/// A [s] is a time of the material, a ratio of its viscosities and elastic moduli. The coefficient of
/// restitution e at the impact velocity v tends to 1 for small v, with B the beta function:
///
///     1 - e = 3/2 A B(3/5, 3/2) v/δ_m + O(A² v²/δ_m²),    δ_m = (5 m* v²/(4 k))^(2/5),    ∝ v^(1/5)
///
/// The force becomes tensile at the end of a contact. `clamped` = 1 sets a tensile force to zero.
struct KuwabaraKono {
    static constexpr const char* name = "kuwabara-kono";
    static constexpr const char* description =
        "Viscoelastic spheres (Kuwabara and Kono 1987): F = 4/3 E* sqrt(R*) (delta^(3/2) + 3/2 A "
        "sqrt(delta) deltadot). 1 - e, with the coefficient of restitution e, is proportional to v^(1/5) for "
        "small impact velocities v.";
    static constexpr const char* example = R"("A": 1e-6)";
    static constexpr bool material_stiffness = true;

    float E_eff = 0;  ///< effective modulus E* [Pa]
    float A = 0;      ///< dissipation time [s]
    int clamped = 0;  ///< 1: no tensile force

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R a = sqrt(contact.R_eff * contact.delta), S = 2 * E_eff * a;
        const R F = S * (Number<R>(2) / 3 * contact.delta + A * contact.v_n);
        return {clamped != 0 ? larger(F, R(0.f)) : F, a, Number<R>(0.5)};
    }

    /// Elastic energy 2/5 k δ^(5/2) [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return Number<R>(8) / 15 * E_eff * sqrt(contact.R_eff * contact.delta) * contact.delta *
               contact.delta;
    }

    /// That of Hertz's theory, or π m*/(A S) of the damper at the largest overlap if it is shorter [s]
    double collision_time(double m_eff, double R_eff, double v) const
    {
        const double E = E_eff, k = 4. / 3 * E * std::sqrt(R_eff),
                     deepest = std::pow(5 * m_eff * v * v / (4 * k), 0.4),
                     S = 2 * E * std::sqrt(R_eff * deepest);
        return std::fmin(2.87 * std::pow(m_eff * m_eff / (R_eff * E * E * v), 0.2),
                         3.14159265358979323846 * m_eff / (double(A) * S));
    }

    template <class Keys>
    static KuwabaraKono read(Keys& keys)
    {
        return {.E_eff = float(effective_modulus(keys.i, keys.j)),
                .A = keys.positive("A", "Dissipation time A of the materials [s].", 1e-6),
                .clamped = keys.flag("clamped", "If true, the normal force is never tensile.")};
    }
};

}  // namespace hilda::granular
