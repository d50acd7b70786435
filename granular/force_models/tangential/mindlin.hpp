// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction with a tangential spring and dashpot of the displacement u.        Fang (2022), Eqs. 2.45 to 2.47

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     u ← u + h v_t,   F° = -k u - γ v_t
///     F_t = F°                                              if |F°| ≤ μ_s |F_n|  (sticking)
///     F_t = μ_k |F_n| F°/|F°|,   u = -(F_t + γ v_t)/k       otherwise            (sliding)
///
/// The bound holds for the sum of spring and dashpot, and u is computed from the bounded force (Luding 2008;
/// Sec. 2.2.1.3). While a contact slides the bound of F° is μ_k |F_n|, so that for μ_s > μ_k it sticks again
/// only below μ_k |F_n|.
///
/// With spring_bound = 1 the bound holds for the spring alone, as Eqs. 2.46 and 2.47 are printed; the sliding
/// distance of a body is then up to 4 % too short:
///
///     F_t = -k u - γ v_t                                    if k |u| < μ_s |F_n|
///     F_t = -μ_k |F_n| u/|u|,   u = -F_t/k                  otherwise
///
/// With rescale = 1 the displacement is reduced with the contact radius a while the contact is unloaded,
/// u ← u a(t_n)/a(t_{n-1}), as the law mindlin_rescale of LAMMPS does: a smaller contact cannot carry the
/// earlier displacement.
///
/// Before each step u is rotated into the tangent plane; see to_tangent_plane().
struct Mindlin {
    static constexpr const char* name = "mindlin";
    static constexpr const char* description =
        "Tangential spring and damper with the elastic displacement as a history variable (Fang "
        "2022, Eqs. 2.45 to 2.47). The Coulomb bound applies to the sum of spring and damper.";

    TangentialSpring spring = {};
    Cap cap = {};
    int spring_bound = 0;  ///< 1: the bound holds for the spring alone
    int rescale = 0;       ///< 1: u is reduced with the contact radius

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal,
                               History<R>& history) const
    {
        const R k = spring.stiffness(normal), gamma = spring.damping(contact, normal);
        Vec<R> u = to_tangent_plane(history.u, contact.n);
        if (rescale != 0) u = unloading_factor(contact, Number<R>(0.5)) * u;
        u += R(contact.h) * contact.v_t;
        if (spring_bound != 0) {
            const auto [F, slides] = cap(-(k * u), abs(normal.F), history.slid);
            history.slid = slides;
            history.u = select(slides, (R(-1.f) / larger(k, R(tiny))) * F, u);
            return select(slides, F, F - gamma * contact.v_t);
        }
        const Vec<R> test = -(k * u) - gamma * contact.v_t;
        const auto [F, slides] = cap(test, abs(normal.F), history.slid);
        history.slid = slides;
        history.u = select(slides, (R(-1.f) / larger(k, R(tiny))) * (F + gamma * contact.v_t), u);
        return F;
    }

    /// Energy of the spring, k u²/2 [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>&, const R& k, const History<R>& history) const
    {
        return Number<R>(0.5) * k * history.u.dot(history.u);
    }

    template <class Keys>
    static Mindlin read(Keys& keys)
    {
        return {
            .spring = TangentialSpring::read(keys),
            .cap = Cap::read(keys),
            .spring_bound = keys.flag(
                "spring_bound",
                "If true, Coulomb's bound applies to the spring alone, as Fang (2022) prints Eqs. 2.46 and "
                "2.47. Sliding distances are then up to 4 % too short."),
            .rescale = keys.flag("rescale",
                                 "If true, the tangential displacement is reduced with the contact radius "
                                 "while the contact is unloaded (mindlin_rescale of LAMMPS).")};
    }
};

}  // namespace hilda::granular
