// SPDX-License-Identifier: GPL-3.0-or-later
/// Tangential spring and dashpot of a contact, and Coulomb's bound.          Fang (2022), Sec. A.5, corrected

#pragma once

#include "granular/core/contact_point.hpp"
#include "granular/core/material.hpp"

namespace hilda::granular {

constexpr float tiny = 1e-30f;  // lower bound of denominators, against 0/0

/// Stiffness k [N/m] and damping constant γ [N s/m] of the tangential spring and dashpot:
///
///     k = k_t s,    γ = c √(m* k) + γ_t m* s
///
/// s is NormalForce::scale. With normal laws whose stiffness is that of the materials k_t = 8 G* [Pa],
/// c = damping(e) and γ_t = 0. With the other normal laws k_t and γ_t are prescribed and c = 0.
struct TangentialSpring {
    float k_t = 0;      ///< [Pa] if it is 8 G*, else [N/m]
    float c = 0;        ///< damping coefficient [-]
    float gamma_t = 0;  ///< [1/s]

    template <class R>
    HILDA_HD R stiffness(const NormalForce<R>& normal) const
    {
        return k_t * normal.scale;
    }
    template <class R>
    HILDA_HD R damping(const ContactPoint<R>& contact, const NormalForce<R>& normal) const
    {
        return c * sqrt(contact.m_eff * stiffness(normal)) + gamma_t * contact.m_eff * normal.scale;
    }

    template <class Keys>
    static TangentialSpring read(Keys& keys)
    {
        if (!keys.material_normal())
            return {.k_t = keys.positive(
                        "k_t",
                        "Tangential stiffness k_t [N/m]. Not allowed with the normal laws hertz, "
                        "hunt-crossley and kuwabara-kono, where it is 8 G* sqrt(R* delta); required with the "
                        "others.",
                        1e4),
                    .c = 0,
                    .gamma_t = keys.not_negative("gamma_t", 0,
                                                 "Tangential damping coefficient per effective mass [1/s]. "
                                                 "Allowed with the same laws as k_t.",
                                                 3)};
        return of_materials(keys.i, keys.j, keys.restitution());
    }
    static TangentialSpring of_materials(const Material& i, const Material& j, double restitution)
    {
        return {.k_t = float(8 * effective_shear_modulus(i, j)),
                .c = float(granular::damping(restitution)),
                .gamma_t = 0};
    }
};

/// Coulomb's bound of the tangential force, the sum of spring and dashpot
struct Cap {
    float mu_s = 0, mu_k = 0;  ///< coefficients of static and kinetic friction

    template <class R>
    struct Capped {
        Vec<R> F;
        Mask<R> slides;
    };
    /// The test force if it is within the bound, else a force of magnitude μ_k N in its direction. The bound
    /// is μ_s N, or μ_k N if the contact was sliding in the previous step.
    template <class R>
    HILDA_HD Capped<R> operator()(const Vec<R>& test, const R& N, const Mask<R>& slid) const
    {
        const R size = test.norm();
        const Mask<R> slides = size > select(slid, R(mu_k), R(mu_s)) * N;
        return {select(slides, mu_k * N / larger(size, R(tiny)), R(1.f)) * test, slides};
    }

    template <class Keys>
    static Cap read(Keys& keys)
    {
        return {.mu_s = keys.static_friction(), .mu_k = keys.kinetic_friction()};
    }
};

/// Factor of a quantity that is proportional to δ^power while the contact is unloaded: its value at t_n over
/// that at t_{n-1}, to first order in h, where the overlap was δ - h dδ/dt. 1 while the contact is loaded.
template <class R>
HILDA_HD inline R unloading_factor(const ContactPoint<R>& contact, Number<R> power)
{
    return select(contact.v_n < R(0.f),
                  larger(R(1.f) + R(power * contact.h) * contact.v_n / contact.delta, R(0.f)), R(1.f));
}

/// Rotates a tangential displacement of the previous step into the tangent plane of the normal n: the
/// component along n is removed and the length is restored. Zero if u is parallel to n.
template <class R>
HILDA_HD inline Vec<R> to_tangent_plane(const Vec<R>& u, const Vec<R>& n)
{
    const R along = u.dot(n), u2 = u.dot(u);
    const Vec<R> in_plane = u - along * n;
    const R in_plane2 = in_plane.dot(in_plane);
    return select(in_plane2 > R(0.f), sqrt(u2 / larger(in_plane2, R(tiny))), R(0.f)) * in_plane;
}

}  // namespace hilda::granular
