// SPDX-License-Identifier: GPL-3.0-or-later
/// A torque of constant size against the relative turning.                                     Fang (2022), Eq. 2.48

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     M = -μ_r R* |F_n| ω_rel/|ω_rel|
///
/// Smooth below the turning `slow`, and below what the torque would stop in 20 steps, so that what rests is left at rest.
/// The lever is R*; with `half_radius` it is half of the radius against a wall too, which the stacking experiments of the
/// dissertation agree with. With `after` the torque begins only when a contact has that age.
struct ConstantTorque {
    static constexpr const char* name = "constant-torque";

    float mu_r = 0;
    float slow = 0;   ///< [rad/s]
    float after = 0;  ///< [s]
    int half_radius = 0;

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& t, const NormalForce<R>& p, R,
                               History<R>& history) const
    {
        const R turning = t.omega.norm();
        const R lever = half_radius != 0 ? Number<R>(0.5) * larger(t.R_i, t.R_j) : t.R_eff;
        const R most = mu_r * lever * abs(p.F);
        constexpr float steps = 20;  // several contacts of one particle may brake it together
        const R stopped = (steps * t.h) * most / (Number<R>(0.4) * t.m_eff * t.R_eff * t.R_eff);
        const R M = most / larger(larger(turning, stopped), R(slow > tiny ? slow : tiny));
        return select(history.age >= R(after), -M, R(0.f)) * t.omega;
    }

    template <class Keys>
    static ConstantTorque read(Keys& keys)
    {
        return {.mu_r = keys.not_negative("mu_r"),
                .slow = keys.not_negative("slow", 1e-4f),
                .after = keys.not_negative("after", 0.f),
                .half_radius = keys.flag("half_radius")};
    }
};

}  // namespace hilda::granular
