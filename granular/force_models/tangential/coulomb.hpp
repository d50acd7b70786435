// SPDX-License-Identifier: GPL-3.0-or-later
/// Coulomb's friction of what slides now, without a history: nothing sticks, what should creeps.

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     F_t = -min(γ_t |v_t|, μ_k |F_n|) v_t/|v_t|
struct Coulomb {
    static constexpr const char* name = "coulomb";

    TangentialSpring spring = {};
    float mu_k = 0;

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& t, const NormalForce<R>& p, History<R>&) const
    {
        const R gamma = spring.damping(t, p), F = gamma * t.v_t.norm(), bound = mu_k * abs(p.F);
        return -(select(F > bound, bound / larger(F, R(tiny)), R(1.f)) * gamma) * t.v_t;
    }

    template <class Keys>
    static Coulomb read(Keys& keys)
    {
        return {.spring = TangentialSpring::read(keys), .mu_k = keys.kinetic_friction()};
    }
};

}  // namespace hilda::granular
