// SPDX-License-Identifier: GPL-3.0-or-later
/// What holds between two materials: one law of each kind. Friction, rolling and spin are bounded by the force of the normal
/// law, without the attraction.

#pragma once

#include "granular/backend/any_of.hpp"
#include "granular/force_models.hpp"  // generated from the files in force_models/

namespace hilda::granular {

struct PairLaw {
    NormalLaws normal;
    TangentialLaws tangential;
    RollingLaws rolling;
    SpinLaws spin;
    CohesionLaws cohesion;

    bool turns() const { return !rolling.is<NoRolling>() || !spin.is<NoSpin>(); }
};

/// Hertz of a material on itself, and Mindlin where mu is positive
inline PairLaw hertz_mindlin(const Material& m, double restitution, double mu = 0)
{
    PairLaw law;
    law.normal = Hertz::of_materials(m, m, restitution);
    if (mu > 0)
        law.tangential = Mindlin{.spring = TangentialSpring::of_materials(m, m, restitution),
                                 .cap = {static_cast<float>(mu), static_cast<float>(mu)}};
    return law;
}

/// What a contact does to body i, and the opposite of to body j but for the levers of F_t
template <class R>
struct ContactForce {
    Vec<R> F;    ///< [N]
    Vec<R> F_t;  ///< of that the part across n
    Vec<R> T;    ///< rolling and spin [N m]
};

/// `turning`: whether any law of the world resists rolling or spin; else T is zero
template <class R>
HILDA_HD inline ContactForce<R> evaluate(const PairLaw& law, const ContactPoint<R>& t, History<R>& history,
                                         bool turning)
{
    NormalForce<R> p{};
    law.normal.visit([&](const auto& l) { p = l(t); });
    ContactForce<R> out{};
    law.tangential.visit([&](const auto& l) { out.F_t = l(t, p, history); });
    R attraction{};
    law.cohesion.visit([&](const auto& l) { attraction = l(t); });
    out.F = (p.F - attraction) * t.n + out.F_t;
    out.T = {R(0.f), R(0.f), R(0.f)};
    if (!turning) return out;
    R k_t = R(0.f), gamma_t = R(0.f);
    law.tangential.visit([&](const auto& l) {
        if constexpr (requires { l.spring; }) k_t = l.spring.stiffness(p), gamma_t = l.spring.damping(t, p);
    });
    law.rolling.visit([&](const auto& l) { out.T += l(t, p, k_t, history); });
    R about_n{};
    law.spin.visit([&](const auto& l) { about_n = l(t, p, k_t, gamma_t, history); });
    out.T += about_n * t.n;
    return out;
}

}  // namespace hilda::granular
