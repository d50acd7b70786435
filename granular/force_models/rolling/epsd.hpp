// SPDX-License-Identifier: GPL-3.0-or-later
/// Rolling resistance: elastic-plastic spring-dashpot (EPSD).                       Fang (2022), Sec. 2.2.1.4

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     M_k ← M_k - h k_r ω_r,  |M_k| ≤ μ_r R* |F_n|;    k_r = k_t R*²
///     M = M_k - C_r ω_r,  C_r = 2 η_r √(I_r k_r) if |M_k| is below its bound, else C_r = 0
///
/// k_t is the current stiffness of the tangential law [N/m]; without friction it is 0, and so is M. ω_r is
/// the part of the relative angular velocity normal to n. I_r = 7/5 m* R*² is the moment of inertia of a
/// sphere about a point of its surface, with m* and R*.
struct Epsd {
    static constexpr const char* name = "epsd";
    static constexpr const char* description =
        "Elastic-plastic spring and damper on the relative rolling rotation (Fang 2022, Sec. "
        "2.2.1.4). The elastic torque is at most mu_r R* |F_n|. It requires a tangential law "
        "other than none.";
    static constexpr const char* example = R"("mu_r": 0.05, "eta_r": 0.3)";

    float mu_r = 0, eta_r = 0;  ///< coefficient of rolling friction, damping ratio

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal, R k_t,
                               History<R>& history) const
    {
        const R k_r = k_t * contact.R_eff * contact.R_eff, bound = mu_r * contact.R_eff * abs(normal.F);
        const Vec<R> omega_r = contact.omega - contact.omega.dot(contact.n) * contact.n;
        const Vec<R> psi = to_tangent_plane(history.psi, contact.n) + R(contact.h) * omega_r;
        const R size = k_r * psi.norm();
        const Mask<R> saturated = size > bound;
        history.psi = select(saturated, bound / larger(size, R(tiny)), R(1.f)) * psi;
        const R I_r = Number<R>(1.4) * contact.m_eff * contact.R_eff * contact.R_eff;
        const R C = select(saturated, R(0.f), 2 * eta_r * sqrt(I_r * k_r));
        return -(k_r * history.psi) - C * omega_r;
    }

    /// Energy of the spring, k_r ψ²/2 [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact, const R& k_t, const History<R>& history) const
    {
        return Number<R>(0.5) * k_t * contact.R_eff * contact.R_eff * history.psi.dot(history.psi);
    }

    template <class Keys>
    static Epsd read(Keys& keys)
    {
        return {.mu_r = keys.coefficient("mu_r", "Coefficient of rolling friction mu_r [-].", 0.05),
                .eta_r = keys.not_negative(
                    "eta_r", 0, "Damping of the rolling spring as a fraction of critical damping [-].", 0.3)};
    }
};

}  // namespace hilda::granular
