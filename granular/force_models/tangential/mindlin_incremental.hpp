// SPDX-License-Identifier: GPL-3.0-or-later
/// Mindlin's force by increments.                                                              Fang (2022), Eq. 2.44

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     T ← T - h k v_t,  |T| ≤ μ_k |F_n|;   F_t = T - γ v_t while it is within that bound
///
/// What is remembered is the elastic force T [N]: with a stiffness that changes with the overlap it is not k u. Where the
/// normal force falls, T is taken down with the stiffness (Thornton and Walton), so that no energy is made.
struct MindlinIncremental {
    static constexpr const char* name = "mindlin-incremental";

    TangentialSpring spring = {};
    Cap cap = {};

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& t, const NormalForce<R>& p, History<R>& history) const
    {
        const R k = spring.stiffness(p), gamma = spring.damping(t, p);
        // k over that of the last step, when the overlap was δ - h δ̇
        const R fell =
            select(t.v_n < R(0.f), larger(R(1.f) + R(p.power * t.h) * t.v_n / t.delta, R(0.f)), R(1.f));
        const Vec<R> T = fell * carried(history.u, t.n) - (R(t.h) * k) * t.v_t;
        const Vec<R> test = T - gamma * t.v_t;
        const auto [F, slides] = cap(test, abs(p.F), history.slid);
        history.slid = slides;
        history.u = select(slides, F + gamma * t.v_t, T);
        return F;
    }

    template <class Keys>
    static MindlinIncremental read(Keys& keys)
    {
        return {.spring = TangentialSpring::read(keys), .cap = Cap::read(keys)};
    }
};

}  // namespace hilda::granular
