// SPDX-License-Identifier: GPL-3.0-or-later
/// Resistance to rolling as a pseudo-force of the objective rolling velocity.              Fang (2022), Sec. 2.2.1.4

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     v_r = -R* n × (ω_i - ω_j),   F_r from ∫ v_r as the tangential force from ∫ v_t, bounded by μ_r |F_n|
///     M = R* n × F_r on body i
struct PseudoForce {
    static constexpr const char* name = "pseudo-force";

    float mu_r = 0;
    float k_r = 0;    ///< stiffness over that of the tangential spring
    float eta_r = 0;  ///< damping over critical

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& t, const NormalForce<R>& p, R k_t,
                               History<R>& history) const
    {
        const R k = k_r * k_t, gamma = 2 * eta_r * sqrt(t.m_eff * k);
        const Vec<R> v_r = -(t.R_eff * t.n.cross(t.omega));
        // kept as the angle over R*, so that one history serves all models
        const Vec<R> s = t.R_eff * carried(history.psi, t.n) + R(t.h) * v_r;
        const Vec<R> test = -(k * s) - gamma * v_r;
        const auto [F, full] = Cap{mu_r, mu_r}(test, abs(p.F), history.slid);
        const Vec<R> kept = select(full, (R(-1.f) / larger(k, R(tiny))) * (F + gamma * v_r), s);
        history.psi = (R(1.f) / t.R_eff) * kept;
        return t.R_eff * t.n.cross(F);
    }

    template <class Keys>
    static PseudoForce read(Keys& keys)
    {
        return {.mu_r = keys.not_negative("mu_r"),
                .k_r = keys.not_negative("k_r", 1.f),
                .eta_r = keys.not_negative("eta_r", 0.f)};
    }
};

}  // namespace hilda::granular
