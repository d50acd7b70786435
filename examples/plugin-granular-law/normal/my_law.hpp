// SPDX-License-Identifier: GPL-3.0-or-later
/// my-law: a bilinear normal law. A starting point for your own granular law.

#pragma once

#include "granular/core/contact_point.hpp"

#include <cmath>

namespace hilda::granular {

///     F = k δ     while the bodies approach,      F = e² k δ     while they separate
///
/// e is the coefficient of restitution: the work k δ²/2 of the approach to the largest overlap δ returns as
/// e² k δ²/2, at every velocity. A collision takes π/2 (1 + 1/e) √(m*/k). The force jumps when the velocity
/// changes its sign.
///
/// Walton and Braun (1986), with the stiffness e² k from zero overlap, which needs no history.
struct MyLaw {
    static constexpr const char* name = "my-law";
    static constexpr const char* description =
        "Bilinear law: F = k delta while the bodies approach, e^2 k delta while they separate.";
    static constexpr const char* example = R"("k": 1e4)";

    float k = 0;        ///< stiffness of the approach [N/m]
    float k_apart = 0;  ///< stiffness of the separation, e² k [N/m]

    /// The force along the normal. R is a number or a pack of numbers: no branch depends on its values.
    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact) const
    {
        const R stiffness = select(contact.v_n < R(0.f), R(k_apart), R(k));  // v_n = dδ/dt
        return {stiffness * contact.delta, R(1.f)};
    }

    /// Reads the keys of the law. The schema has their names, texts and examples from here.
    template <class Keys>
    static MyLaw read(Keys& keys)
    {
        const float k = keys.positive("k", "Stiffness k of the approach [N/m].", 1e4);
        const auto e = static_cast<float>(keys.restitution());
        return {.k = k, .k_apart = e * e * k};
    }

    /// Duration of a collision without damping [s], for the limit of the time step
    double collision_time(double m_eff, double, double) const { return M_PI * std::sqrt(m_eff / k); }
};

}  // namespace hilda::granular
