// SPDX-License-Identifier: GPL-3.0-or-later
/// Coulomb friction with viscous regularisation, without history.
///
/// There is no static friction: a body under a tangential load below the bound creeps.

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     F_t = -min(γ_t |v_t|, μ_k |F_n|) v_t/|v_t|
struct Coulomb {
    static constexpr const char* name = "coulomb";
    static constexpr const char* description =
        "Viscous tangential force bounded by mu F_n, without a spring. It has no static regime: a "
        "body on an incline creeps.";

    TangentialSpring spring = {};
    float mu_k = 0;  ///< coefficient of kinetic friction

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal,
                               History<R>&) const
    {
        const R gamma = spring.damping(contact, normal), F = gamma * contact.v_t.norm(),
                bound = mu_k * abs(normal.F);
        return -(select(F > bound, bound / larger(F, R(tiny)), R(1.f)) * gamma) * contact.v_t;
    }

    template <class Keys>
    static Coulomb read(Keys& keys)
    {
        Coulomb law{.spring = TangentialSpring::read(keys), .mu_k = keys.kinetic_friction()};
        if (!keys.material_normal() && !(law.spring.gamma_t > 0))
            keys.refuse("gamma_t",
                        "gamma_t must be positive with the tangential law coulomb, which has no force "
                        "without it, got 0");
        return law;
    }
};

}  // namespace hilda::granular
