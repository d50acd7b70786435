// SPDX-License-Identifier: GPL-3.0-or-later
/// Rolling resistance: pseudo-force from the objective rolling velocity.            Fang (2022), Sec. 2.2.1.4

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     v_r = -R* n × (ω_i - ω_j),   F_r from ∫ v_r as the tangential force from ∫ v_t, bounded by μ_r |F_n|
///     M = R* n × F_r on body i
///
/// The stiffness of F_r is k_r times the current stiffness of the tangential law. The signs of v_r and F_r
/// depend on the direction of n; M does not.
struct PseudoForce {
    static constexpr const char* name = "pseudo-force";
    static constexpr const char* description =
        "Elastic-plastic pseudo-force on the objective rolling displacement (Fang 2022, Sec. "
        "2.2.1.4), bounded by mu_r |F_n|. It requires a tangential law other than none.";
    static constexpr const char* example = R"("mu_r": 0.05, "k_r": 2, "eta_r": 0.3)";

    float mu_r = 0;   ///< coefficient of rolling friction
    float k_r = 0;    ///< ratio of the stiffness to that of the tangential spring
    float eta_r = 0;  ///< damping ratio

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal, R k_t,
                               History<R>& history) const
    {
        const R k = k_r * k_t, gamma = 2 * eta_r * sqrt(contact.m_eff * k);
        const Vec<R> v_r = -(contact.R_eff * contact.n.cross(contact.omega));
        // stored as an angle, s/R*, as in the other rolling laws
        const Vec<R> s = contact.R_eff * to_tangent_plane(history.psi, contact.n) + R(contact.h) * v_r;
        const Vec<R> test = -(k * s) - gamma * v_r;
        const auto [F, saturated] = Cap{mu_r, mu_r}(test, abs(normal.F), history.slid);
        const Vec<R> elastic = select(saturated, (R(-1.f) / larger(k, R(tiny))) * (F + gamma * v_r), s);
        history.psi = (R(1.f) / contact.R_eff) * elastic;
        return contact.R_eff * contact.n.cross(F);
    }

    /// Energy of the spring [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact, const R& k_t, const History<R>& history) const
    {
        return Number<R>(0.5) * k_r * k_t * contact.R_eff * contact.R_eff * history.psi.dot(history.psi);
    }

    template <class Keys>
    static PseudoForce read(Keys& keys)
    {
        return {.mu_r = keys.coefficient("mu_r", "Coefficient of rolling friction mu_r [-].", 0.05),
                .k_r = keys.not_negative(
                    "k_r", 1, "Rolling stiffness as a multiple of the tangential stiffness [-].", 2),
                .eta_r = keys.not_negative(
                    "eta_r", 0, "Damping of the rolling spring as a fraction of critical damping [-].", 0.3)};
    }
};

}  // namespace hilda::granular
