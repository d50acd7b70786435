// SPDX-License-Identifier: GPL-3.0-or-later
/// Rolling resistance: torque of constant magnitude against the relative rotation.      Fang (2022), Eq. 2.48

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     M = -μ_r R* |F_n| ω_rel/|ω_rel|
///
/// The torque is proportional to ω_rel, and thus continuous, for |ω_rel| below the larger of `slow` and the
/// angular velocity that the full torque would stop in 20 steps. It therefore does not reverse a
/// rotation.
///
/// The lever arm is R*. With `half_radius` = 1 it is R/2, R the larger radius, for contacts with boundaries
/// as well; the results of the stacking test of the dissertation (Sec. 7.1.4) agree with R/2. The torque is
/// zero until the contact has the age `after`.
struct ConstantTorque {
    static constexpr const char* name = "constant-torque";
    static constexpr const char* description =
        "Torque of constant magnitude mu_r R* |F_n| that opposes the relative angular velocity "
        "(Fang 2022, Eq. 2.48).";
    static constexpr const char* example = R"("mu_r": 0.05)";

    float mu_r = 0;       ///< coefficient of rolling friction
    float slow = 0;       ///< angular velocity below which the torque is regularised [rad/s]
    float after = 0;      ///< age of the contact from which the torque acts [s]
    int half_radius = 0;  ///< 1: lever arm R/2 instead of R*

    /// The law with the lever arm R/2 of the dissertation, with which the results of Sec. 7.1.4 agree
    static ConstantTorque with_half_radius(double mu_r, double slow = 1e-4)
    {
        return {.mu_r = static_cast<float>(mu_r), .slow = static_cast<float>(slow), .half_radius = 1};
    }

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal, R,
                               History<R>& history) const
    {
        const R speed = contact.omega.norm();
        const R lever = half_radius != 0 ? Number<R>(0.5) * larger(contact.R_i, contact.R_j) : contact.R_eff;
        const R bound = mu_r * lever * abs(normal.F);
        constexpr float steps = 20;  // a margin, because several contacts may act on one particle
        const R stop_limit =
            (steps * contact.h) * bound / (Number<R>(0.4) * contact.m_eff * contact.R_eff * contact.R_eff);
        const R M = bound / larger(larger(speed, stop_limit), R(slow > tiny ? slow : tiny));
        return select(history.age >= R(after), -M, R(0.f)) * contact.omega;
    }

    template <class Keys>
    static ConstantTorque read(Keys& keys)
    {
        return {.mu_r = keys.coefficient("mu_r", "Coefficient of rolling friction mu_r [-].", 0.05),
                .slow = keys.not_negative(
                    "slow", 1e-4,
                    "Relative angular velocity below which the torque is proportional to it [rad/s].", 0.001),
                .after = keys.not_negative("after", 0, "Age of the contact from which the torque acts [s].",
                                           0.001),
                .half_radius = keys.flag(
                    "half_radius",
                    "If true, the lever arm is half of the larger radius instead of R*. The two differ for "
                    "contacts with a boundary only, or between particles of different size.")};
    }
};

}  // namespace hilda::granular
