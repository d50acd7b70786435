// SPDX-License-Identifier: GPL-3.0-or-later
/// Linear springs with plastic overlap: a stiffer spring unloads the contact.
///                                                              Walton and Braun, J. Rheol. 30 (1986)

#pragma once

#include "granular/core/contact_point.hpp"

#include <cmath>

namespace hilda::granular {

///     F = k_1 δ                                    while δ is the largest overlap δ_max of the contact
///     F = max(0, k_1 δ_max - K_2 (δ_max - δ))      below: unloading and reloading
///     K_2 = k_2 + S k_1 δ_max
///
/// After unloading the overlap δ_0 = δ_max (1 - k_1/K_2) remains without a force; there is no tension.
/// Reloading follows the line of K_2 up to δ_max, and then that of k_1. When the bodies separate, δ_max is
/// forgotten: the next contact begins at δ = 0.
///
/// With S = 0 the coefficient of restitution is e = √(k_1/k_2) for all velocities. With S > 0 the stiffness
/// K_2 grows with the largest force k_1 δ_max, and e decreases with the impact velocity v:
///
///     e = √(k_1/(k_2 + S v √(m* k_1)))
struct WaltonBraun {
    static constexpr const char* name = "walton-braun";
    static constexpr const char* description =
        "Linear springs with plastic overlap (Walton and Braun 1986): stiffness k_1 while the overlap "
        "grows, k_2 + S k_1 delta_max for unloading and reloading below the largest overlap delta_max, no "
        "tension. The coefficient of restitution is sqrt(k_1/k_2) if S = 0.";
    static constexpr const char* example = R"("k_1": 1e4, "k_2": 2e4)";
    static constexpr bool internal_variables = true;

    float k_1 = 0;  ///< stiffness of loading [N/m]
    float k_2 = 0;  ///< stiffness of unloading at zero force [N/m], at least k_1
    float S = 0;    ///< growth of the stiffness of unloading with the largest force [1/m]

    template <class R>
    HILDA_HD R unloading_stiffness(const R& largest) const
    {
        return k_2 + S * (k_1 * largest);
    }

    template <class R>
    HILDA_HD NormalForce<R> operator()(const ContactPoint<R>& contact, History<R>& history) const
    {
        const R largest = larger(history.largest_overlap, contact.delta);
        history.largest_overlap = largest;
        const R F = k_1 * largest - unloading_stiffness(largest) * (largest - contact.delta);
        return {larger(F, R(0.f)), R(1.f)};
    }

    /// Recoverable energy F²/(2 K_2) [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact, const History<R>& history) const
    {
        History<R> now = history;
        const R F = (*this)(contact, now).F;
        return Number<R>(0.5) * F * F / unloading_stiffness(now.largest_overlap);
    }

    /// Half of the period with the stiffness of unloading at the largest force v √(m* k_1) [s]
    double collision_time(double m_eff, double, double v) const
    {
        const double K_2 = k_2 + double(S) * v * std::sqrt(m_eff * double(k_1));
        return 3.14159265358979323846 * std::sqrt(m_eff / K_2);
    }

    template <class Keys>
    static WaltonBraun read(Keys& keys)
    {
        WaltonBraun law;
        law.k_1 = keys.positive("k_1", "Stiffness k_1 of loading [N/m].", 1e4);
        law.k_2 = keys.at_least("k_2", law.k_1, "k_1",
                                "Stiffness k_2 of unloading [N/m], at least k_1. If it is absent, it is "
                                "k_1/e^2 with the key restitution, which is then required.",
                                2e4);
        law.S = keys.not_negative(
            "S", 0, "Growth of the stiffness of unloading with the largest force of the contact [1/m].", 100);
        if (law.k_2 == 0) {
            const double e = keys.restitution();
            law.k_2 = float(law.k_1 / (e * e));
        } else {
            keys.restitution_instead_of("k_2");  // refused
        }
        return law;
    }
};

}  // namespace hilda::granular
