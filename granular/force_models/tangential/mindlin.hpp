// SPDX-License-Identifier: GPL-3.0-or-later
/// A spring and dashpot that remembers how far the surfaces have slid.                 Fang (2022), Eqs. 2.45 to 2.47

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     u ← u + h v_t,   F° = -k u - γ v_t;   F_t = F° where |F°| ≤ μ_s |F_n|,  else μ_k |F_n| F°/|F°| and u = -(F_t + γ v_t)/k
///
/// The cap is on spring and dashpot together, and the spring is solved back from it (Luding 2008); (2.46) caps the spring
/// alone, and stops a sliding body up to 4 % too early. With μ_s above μ_k what slides goes on with μ_k until the test force
/// is below that.
struct Mindlin {
    static constexpr const char* name = "mindlin";

    TangentialSpring spring = {};
    Cap cap = {};

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& t, const NormalForce<R>& p, History<R>& history) const
    {
        const R k = spring.stiffness(p), gamma = spring.damping(t, p);
        const Vec<R> u = carried(history.u, t.n) + R(t.h) * t.v_t;
        const Vec<R> test = -(k * u) - gamma * t.v_t;
        const auto [F, slides] = cap(test, abs(p.F), history.slid);
        history.slid = slides;
        history.u = select(slides, (R(-1.f) / larger(k, R(tiny))) * (F + gamma * t.v_t), u);
        return F;
    }

    template <class Keys>
    static Mindlin read(Keys& keys)
    {
        return {.spring = TangentialSpring::read(keys), .cap = Cap::read(keys)};
    }
};

}  // namespace hilda::granular
