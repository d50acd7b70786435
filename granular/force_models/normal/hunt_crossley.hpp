// SPDX-License-Identifier: GPL-3.0-or-later
/// Hertzian contact with damping proportional to the elastic force.
///                                                     Hunt and Crossley, J. Appl. Mech. 42 (1975)

#pragma once

#include "granular/core/contact_point.hpp"
#include "granular/core/material.hpp"

#include <cmath>

namespace hilda::granular {

///     F = k δ^(3/2) (1 + 3/2 α δ̇),    k = 4/3 E* √R*
///
/// The force is continuous at both ends of a contact and not tensile in a free collision. The coefficient of
/// restitution e at the impact velocity v does not depend on the mass and the stiffness, with β = 3/2 α:
///
///     β v - ln(1 + β v) = -β e v - ln(1 - β e v),    e = 1 - α v + O(α² v²)
struct HuntCrossley {
    static constexpr const char* name = "hunt-crossley";
    static constexpr const char* description =
        "Hertzian contact with damping proportional to the elastic force (Hunt and Crossley 1975): F = 4/3 "
        "E* "
        "sqrt(R*) delta^(3/2) (1 + 3/2 alpha deltadot). The coefficient of restitution is 1 - alpha v for "
        "small impact velocities v.";
    static constexpr const char* example = R"("alpha": 0.2)";
    static constexpr bool material_stiffness = true;

    float E_eff = 0;  ///< effective modulus E* [Pa]
    float alpha = 0;  ///< decrease of the coefficient of restitution with the impact velocity [s/m]

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R a = sqrt(contact.R_eff * contact.delta);
        const R elastic = Number<R>(4) / 3 * E_eff * a * contact.delta;
        const R F = elastic * (R(1.f) + Number<R>(1.5) * alpha * contact.v_n);
        return {larger(F, R(0.f)), a, Number<R>(0.5)};  // a fast separation by other forces has no tension
    }

    /// Elastic energy 2/5 k δ^(5/2) [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return Number<R>(8) / 15 * E_eff * sqrt(contact.R_eff * contact.delta) * contact.delta *
               contact.delta;
    }

    /// That of Hertz's theory with the stiffness k (1 + 3/2 α v), the largest of the collision [s]
    double collision_time(double m_eff, double R_eff, double v) const
    {
        const double E = double(E_eff) * (1 + 1.5 * double(alpha) * v);
        return 2.87 * std::pow(m_eff * m_eff / (R_eff * E * E * v), 0.2);
    }

    template <class Keys>
    static HuntCrossley read(Keys& keys)
    {
        return {
            .E_eff = float(effective_modulus(keys.i, keys.j)),
            .alpha = keys.positive("alpha",
                                   "Damping coefficient alpha [s/m]. The coefficient of restitution at the "
                                   "impact velocity v is 1 - alpha v for small alpha v.",
                                   0.2)};
    }
};

}  // namespace hilda::granular
