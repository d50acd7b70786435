// SPDX-License-Identifier: GPL-3.0-or-later
/// Spin resistance: bounded torsional spring-dashpot about the contact normal.      Fang (2022), Sec. 2.2.1.5

#pragma once

#include "granular/force_models/tangential/spring.hpp"

#include <numbers>

namespace hilda::granular {

///     M = -K ∫ω_sp dt - D ω_sp   (Eq. 2.51),   |M| ≤ 2/3 μ |F_n| a
///     K = k_t a²/2,  D = γ_t a²/2,  a = √(R* δ),  ω_sp = n · (ω_i - ω_j)
///
/// k_t [N/m] and γ_t [N s/m] are the current stiffness and damping constant of the tangential law. The bound
/// holds for the sum of spring and dashpot; at the bound the angle is computed back from M.
///
/// 2/3 μ |F_n| a is the torque of a uniform pressure. With critical = 1 the bound is that of the pressure of
/// Hertz's theory, at which the whole contact area slips: 3π/16 μ |F_n| a (Sec. 2.2.1.5).
struct TorsionalSpring {
    static constexpr const char* name = "torsional-spring";
    static constexpr const char* description =
        "Torsional spring and damper about the normal (Fang 2022, Eq. 2.51). The torque is at "
        "most 2/3 mu |F_n| a with the contact radius a = sqrt(R* delta). It requires a tangential "
        "law other than none.";

    float mu = 0;      ///< coefficient of kinetic friction
    int critical = 0;  ///< 1: bound of the pressure of Hertz's theory

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal, R k_t, R gamma_t,
                          History<R>& history) const
    {
        const R a2 = contact.R_eff * contact.delta, K = Number<R>(0.5) * k_t * a2,
                D = Number<R>(0.5) * gamma_t * a2;
        const R omega_sp = contact.n.dot(contact.omega), angle = history.spin + R(contact.h) * omega_sp;
        const R test = -(K * angle) - D * omega_sp, size = abs(test);
        const Number<R> factor = critical != 0 ? Number<R>(3 * std::numbers::pi / 16) : Number<R>(2) / 3;
        const R bound = factor * mu * abs(normal.F) * sqrt(a2);
        const Mask<R> saturated = size > bound;
        const R M = select(saturated, bound / larger(size, R(tiny)), R(1.f)) * test;
        history.spin = select(saturated, -(M + D * omega_sp) / larger(K, R(tiny)), angle);
        return M;
    }

    /// Energy of the spring, K/2 times the square of its angle [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact, const R& k_t, const History<R>& history) const
    {
        return Number<R>(0.25) * k_t * contact.R_eff * contact.delta * history.spin * history.spin;
    }

    template <class Keys>
    static TorsionalSpring read(Keys& keys)
    {
        return {.mu = keys.kinetic_friction(),
                .critical =
                    keys.flag("critical",
                              "If true, the torque is at most 3 pi/16 mu |F_n| a, at which the whole area "
                              "of a Hertzian contact slips, instead of 2/3 mu |F_n| a.")};
    }
};

}  // namespace hilda::granular
