// SPDX-License-Identifier: GPL-3.0-or-later
/// Hertzian contact, damping from a coefficient of restitution.  Fang (2022), Eq. 2.42; Sec. A.5, corrected

#pragma once

#include "granular/core/contact_point.hpp"
#include "granular/core/material.hpp"

namespace hilda::granular {

///     F = 2/3 S δ + c √(m* S) δ̇,    S = 2 E* √(R* δ),   c = -2 √(5/6) ln e / √(ln² e + π²)
///
/// The force becomes tensile at the end of a contact; the coefficient of restitution e is obtained with this
/// tension. `clamped` = 1 sets a tensile force to zero. The rebound is then faster: the ratio of
/// rebound to impact velocity is 0.25 for e = 0.1 and 0.55 for e = 0.5.
struct Hertz {
    static constexpr const char* name = "hertz";
    static constexpr const char* description =
        "Hertzian contact with damping (Fang 2022, Eq. 2.42): F = 2/3 S delta + c sqrt(m* S) "
        "deltadot with S = 2 E* sqrt(R* delta) and c from the coefficient of restitution.";
    static constexpr bool material_stiffness = true;

    float E_eff = 0;  ///< effective modulus E* [Pa]
    float c = 0;      ///< damping coefficient [-]; see damping()
    int clamped = 0;  ///< 1: no tensile force

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R a = sqrt(contact.R_eff * contact.delta), S = 2 * E_eff * a;
        const R F = Number<R>(2) / 3 * S * contact.delta + c * sqrt(contact.m_eff * S) * contact.v_n;
        return {clamped != 0 ? larger(F, R(0.f)) : F, a, Number<R>(0.5)};
    }

    /// Elastic energy 4/15 S δ² [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return Number<R>(8) / 15 * E_eff * sqrt(contact.R_eff * contact.delta) * contact.delta *
               contact.delta;
    }

    template <class Keys>
    static Hertz read(Keys& keys)
    {
        Hertz law = of_materials(keys.i, keys.j, keys.restitution());
        law.clamped = keys.flag("clamped",
                                "If true, the normal force is never tensile. The restitution is then higher "
                                "than the value given: 0.25 for e = 0.1, 0.55 for e = 0.5.");
        return law;
    }
    static Hertz of_materials(const Material& i, const Material& j, double restitution)
    {
        return {.E_eff = float(effective_modulus(i, j)), .c = float(damping(restitution)), .clamped = 0};
    }
};

}  // namespace hilda::granular
