// SPDX-License-Identifier: GPL-3.0-or-later
/// A torsional spring about the normal, capped.                                                Fang (2022), Eq. 2.51

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     M = -K ∫ω_sp - D ω_sp,   |M| ≤ 2/3 μ |F_n| a;    K = k_t a²/2,  D = γ_t a²/2,  a = √(R* δ)
struct TorsionalSpring {
    static constexpr const char* name = "torsional-spring";

    float mu = 0;

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& t, const NormalForce<R>& p, R k_t, R gamma_t,
                          History<R>& history) const
    {
        const R a2 = t.R_eff * t.delta, K = Number<R>(0.5) * k_t * a2, D = Number<R>(0.5) * gamma_t * a2;
        const R omega_sp = t.n.dot(t.omega), angle = history.spin + R(t.h) * omega_sp;
        const R test = -(K * angle) - D * omega_sp, size = abs(test);
        const R bound = Number<R>(2) / 3 * mu * abs(p.F) * sqrt(a2);
        const Mask<R> full = size > bound;
        const R M = select(full, bound / larger(size, R(tiny)), R(1.f)) * test;
        history.spin = select(full, -(M + D * omega_sp) / larger(K, R(tiny)), angle);
        return M;
    }

    template <class Keys>
    static TorsionalSpring read(Keys& keys)
    {
        return {.mu = keys.kinetic_friction()};
    }
};

}  // namespace hilda::granular
