// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction with an incremental elastic force (Mindlin and Deresiewicz, simplified).    Fang (2022), Eq. 2.44

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     T ← s T - h k v_t,   F° = T - γ v_t
///     F_t = F°                                              if |F°| ≤ μ_s |F_n|  (sticking)
///     F_t = μ_k |F_n| F°/|F°|,   T = F_t + γ v_t            otherwise            (sliding)
///
/// The history stores the elastic force T [N] instead of a displacement: with a stiffness k that depends on
/// the overlap, T is not -k u. While the contact is unloaded T is reduced with the stiffness, s =
/// k(t_n)/k(t_{n-1}) (Thornton and Walton); otherwise s = 1. Without the reduction the law would generate
/// energy.
struct MindlinIncremental {
    static constexpr const char* name = "mindlin-incremental";
    static constexpr const char* description =
        "Tangential spring and damper with the elastic force as a history variable (Fang 2022, "
        "Eq. 2.44). The elastic force decreases with the stiffness when the contact is unloaded.";

    TangentialSpring spring = {};
    Cap cap = {};

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal,
                               History<R>& history) const
    {
        const R k = spring.stiffness(normal), gamma = spring.damping(contact, normal);
        const R reduction = unloading_factor(contact, normal.power);
        const Vec<R> T =
            reduction * to_tangent_plane(history.u, contact.n) - (R(contact.h) * k) * contact.v_t;
        const Vec<R> test = T - gamma * contact.v_t;
        const auto [F, slides] = cap(test, abs(normal.F), history.slid);
        history.slid = slides;
        history.u = select(slides, F + gamma * contact.v_t, T);
        return F;
    }

    /// Energy of the spring, T²/(2 k) [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>&, const R& k, const History<R>& history) const
    {
        return Number<R>(0.5) * history.u.dot(history.u) / larger(k, R(tiny));
    }

    template <class Keys>
    static MindlinIncremental read(Keys& keys)
    {
        return {.spring = TangentialSpring::read(keys), .cap = Cap::read(keys)};
    }
};

}  // namespace hilda::granular
