// SPDX-License-Identifier: GPL-3.0-or-later
/// The spring and dashpot across a contact.                                            Fang (2022), Sec. A.5, corrected

#pragma once

#include "granular/core/contact_point.hpp"
#include "granular/core/material.hpp"

namespace hilda::granular {

constexpr float tiny = 1e-30f;  // keeps a quotient finite whose numerator is zero

/// Stiffness k_t times the scale of the normal law. With Hertz of materials k_t is 8 G*, else it is given [N/m].
///
///     k = k_t scale,    γ = c √(m* k)  of materials,   γ_t m* scale  where it is given [1/s]
struct TangentialSpring {
    float k_t = 0, c = 0, gamma_t = 0;

    template <class R>
    HILDA_HD R stiffness(const NormalForce<R>& p) const
    {
        return k_t * p.scale;
    }
    template <class R>
    HILDA_HD R damping(const ContactPoint<R>& t, const NormalForce<R>& p) const
    {
        return c * sqrt(t.m_eff * stiffness(p)) + gamma_t * t.m_eff * p.scale;
    }

    template <class Keys>
    static TangentialSpring read(Keys& keys)
    {
        if (!keys.material_normal())
            return {.k_t = keys.positive("k_t"), .c = 0, .gamma_t = keys.not_negative("gamma_t")};
        return of_materials(keys.i, keys.j, keys.restitution());
    }
    static TangentialSpring of_materials(const Material& i, const Material& j, double restitution)
    {
        return {.k_t = float(8 * effective_shear_modulus(i, j)),
                .c = float(granular::damping(restitution)),
                .gamma_t = 0};
    }
};

/// Coulomb's bound on spring and dashpot together
struct Cap {
    float mu_s = 0, mu_k = 0;

    template <class R>
    struct Capped {
        Vec<R> F;
        Mask<R> slides;
    };
    /// The test force, or μ_k N along it where it is above μ_s N; above μ_k N for what slides already
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

/// A displacement of the last step in the tangent plane of this one: without its part along n, and as long as before
template <class R>
HILDA_HD inline Vec<R> carried(const Vec<R>& u, const Vec<R>& n)
{
    const R along = u.dot(n), before = u.dot(u);
    const Vec<R> in_plane = u - along * n;
    const R now = in_plane.dot(in_plane);
    return select(now > R(0.f), sqrt(before / larger(now, R(tiny))), R(0.f)) * in_plane;
}

}  // namespace hilda::granular
