// SPDX-License-Identifier: GPL-3.0-or-later
/// The force model of a pair of materials: one law each for normal force, friction, rolling, spin and
/// cohesion.
///
/// The bounds of friction, rolling and spin use the normal force without the attraction of the cohesion law.

#pragma once

#include "granular/backend/any_of.hpp"
#include "granular/force_models.hpp"  // generated from the files in force_models/

#include <algorithm>

namespace hilda::granular {

/// Whether the stiffness of a normal law is computed from the moduli of the materials, as the law states by
/// `static constexpr bool material_stiffness = true`. The tangential stiffness is then 8 G* a.
template <class Law>
constexpr bool has_material_stiffness = [] {
    if constexpr (requires { Law::material_stiffness; }) return Law::material_stiffness;
    return false;
}();

/// Whether a law uses the internal variables of History, as it states by
/// `static constexpr bool internal_variables = true`
template <class Law>
constexpr bool has_internal_variables = [] {
    if constexpr (requires { Law::internal_variables; }) return Law::internal_variables;
    return false;
}();

/// The force of a normal law. A law with internal variables has the history as its second argument.
template <class Law, class R>
HILDA_HD inline NormalForce<R> normal_force(const Law& law, const ContactPoint<R>& contact,
                                            History<R>& history)
{
    if constexpr (requires { law(contact, history); })
        return law(contact, history);
    else
        return law(contact);
}

/// The laws of a pair of materials. The default is `none` for all but the normal law, which must be set.
struct PairLaw {
    NormalLaws normal;
    TangentialLaws tangential;
    RollingLaws rolling;
    SpinLaws spin;
    CohesionLaws cohesion;
    Lever lever = Lever::radius;  ///< of the tangential force

    /// Whether there is a law of rolling or spin
    bool resists_rotation() const { return !rolling.is<NoRolling>() || !spin.is<NoSpin>(); }
    /// Whether a law has internal variables
    bool has_internal() const
    {
        bool any = false;
        const auto check = [&]<class Law>(const Law&) { any = any || has_internal_variables<Law>; };
        normal.visit(check), tangential.visit(check), rolling.visit(check), spin.visit(check);
        return any;
    }
    /// Whether the elastic energy of the normal force and of the cohesion is known: the laws have a member
    /// energy().
    bool has_energy() const
    {
        bool known = true;
        const auto check = [&]<class Law>(const Law&) {
            known = known && (
                                 requires(const Law& l, const ContactPoint<float>& c) { l.energy(c); } ||
                                 requires(const Law& l, const ContactPoint<float>& c,
                                          const History<float>& h) { l.energy(c, h); });
        };
        normal.visit(check), cohesion.visit(check);
        return known;
    }
};

/// Hertzian contact of a material with itself: `hertz`, and `mindlin` with the friction coefficient mu
/// unless mu = 0. Stiffness and damping follow from E, nu and the coefficient of restitution.
inline PairLaw hertz_mindlin(const Material& m, double restitution, double mu = 0)
{
    PairLaw law;
    law.normal = Hertz::of_materials(m, m, restitution);
    if (mu > 0)
        law.tangential = Mindlin{.spring = TangentialSpring::of_materials(m, m, restitution),
                                 .cap = {static_cast<float>(mu), static_cast<float>(mu)}};
    return law;
}

/// Force and torque of a contact on body i. Body j is subject to -F and -T, and to the torque of F_t with its
/// own lever arm.
template <class R>
struct ContactForce {
    Vec<R> F;    ///< total force [N]
    Vec<R> F_t;  ///< its tangential part [N]
    Vec<R> T;    ///< torque of rolling and spin [N m]
};

/// Torque of the tangential force
template <class R>
struct FrictionTorque {
    Vec<R> M;  ///< torque over the radius, for both bodies [N]
    R depth;   ///< distance of the point of application to the surface of i or of the boundary [m]
};

/// The torque of the tangential force of a contact: M = -(1 - q) n × F_t, with q = 0 for Lever::radius and
/// lever_reduction() for Lever::contact.
template <class R>
HILDA_HD inline FrictionTorque<R> friction_torque(const PairLaw& law, const ContactPoint<R>& contact,
                                                  const Vec<R>& F_t)
{
    const Vec<R> M = -contact.n.cross(F_t);
    if (law.lever == Lever::radius) return {M, R(0.f)};
    const R q = lever_reduction(contact);
    return {(R(1.f) - q) * M, q * contact.R_i};
}

/// Evaluates the laws of a contact and advances its history by one step.
///
///     F = (F_n - F_c) n + F_t,    T = M_r + M_sp n
///
/// With rotation_laws = false the laws of rolling and spin are not evaluated, and T = 0. With with_internal =
/// false no law of the world has internal variables, and the code of such laws is left out.
template <bool with_internal = true, class R>
HILDA_HD inline ContactForce<R> evaluate(const PairLaw& law, const ContactPoint<R>& contact,
                                         History<R>& history, bool rotation_laws)
{
    const auto visit = [](const auto& laws, const auto& f) {
        laws.visit([&]<class Law>(const Law& l) {
            if constexpr (with_internal || !has_internal_variables<Law>) f(l);
        });
    };
    NormalForce<R> normal{};
    visit(law.normal, [&](const auto& l) { normal = normal_force(l, contact, history); });
    ContactForce<R> out{};
    visit(law.tangential, [&](const auto& l) { out.F_t = l(contact, normal, history); });
    R attraction{};
    law.cohesion.visit([&](const auto& l) { attraction = l(contact); });
    out.F = (normal.F - attraction) * contact.n + out.F_t;
    out.T = {R(0.f), R(0.f), R(0.f)};
    if (!rotation_laws) return out;
    R k_t = R(0.f), gamma_t = R(0.f);
    visit(law.tangential, [&](const auto& l) {
        if constexpr (requires { l.spring; })
            k_t = l.spring.stiffness(normal), gamma_t = l.spring.damping(contact, normal);
    });
    visit(law.rolling, [&](const auto& l) { out.T += l(contact, normal, k_t, history); });
    R about_n{};
    visit(law.spin, [&](const auto& l) { about_n = l(contact, normal, k_t, gamma_t, history); });
    out.T += about_n * contact.n;
    return out;
}

/// Stiffness ∂F/∂δ of the normal law without damping, the larger one of loading and unloading [N/m]
inline double normal_stiffness(const PairLaw& law, ContactPoint<double> contact,
                               const History<double>& history)
{
    contact.v_n = 0;
    const double delta = contact.delta, change = 1e-4 * delta;
    const auto force = [&](double overlap) {
        NormalForce<double> normal{};
        History<double> now = history;
        contact.delta = overlap;
        law.normal.visit([&](const auto& l) { normal = normal_force(l, contact, now); });
        return normal.F;
    };
    const double F = force(delta);
    return std::max(force(delta + change) - F, F - force(delta - change)) / change;
}

/// Elastic energy of a contact: of the normal spring with the cohesion, and of the springs of friction,
/// rolling and spin [J]
template <class R>
struct ElasticEnergy {
    R normal, tangential;
};

/// The elastic energy of a contact. Of the members of `contact` it uses the overlap, the radii and the
/// masses. A law without a member energy() contributes nothing.
///
///     normal law, cohesion:        energy(contact), or energy(contact, history) with internal variables
///     friction, rolling, spin:     energy(contact, k_t, history), k_t the stiffness of the tangential spring
template <class R>
HILDA_HD inline ElasticEnergy<R> elastic_energy(const PairLaw& law, const ContactPoint<R>& contact,
                                                const History<R>& history, bool rotation_laws)
{
    ElasticEnergy<R> U{R(0.f), R(0.f)};
    NormalForce<R> normal{};
    law.normal.visit([&](const auto& l) {
        History<R> now = history;
        normal = normal_force(l, contact, now);
        if constexpr (requires { l.energy(contact); }) U.normal += l.energy(contact);
        if constexpr (requires { l.energy(contact, history); }) U.normal += l.energy(contact, history);
    });
    law.cohesion.visit([&](const auto& l) {
        if constexpr (requires { l.energy(contact); }) U.normal += l.energy(contact);
    });
    R k_t = R(0.f);
    law.tangential.visit([&](const auto& l) {
        if constexpr (requires { l.spring; }) k_t = l.spring.stiffness(normal);
    });
    const auto add_spring = [&](const auto& l) {
        if constexpr (requires { l.energy(contact, k_t, history); })
            U.tangential += l.energy(contact, k_t, history);
    };
    law.tangential.visit(add_spring);
    if (!rotation_laws) return U;
    law.rolling.visit(add_spring), law.spin.visit(add_spring);
    return U;
}

}  // namespace hilda::granular
