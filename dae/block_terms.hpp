// SPDX-License-Identifier: GPL-3.0-or-later
/// Terms that the blocks have in common: derivatives of body-fixed vectors, and the pattern of a cross
/// product.

#pragma once

#include "dae/block.hpp"

namespace hilda::dae {

/// A body-fixed vector a = A ā and its time derivatives without the angular acceleration, in the global
/// frame: v = a, vdot = ω × a, centripetal = ω × (ω × a)
struct BodyFixedVector {
    Vec3 v, vdot, centripetal;

    BodyFixedVector(const Motion& body, const Vec3& a_bar)
        : v(body.A * a_bar), vdot(body.A * body.omega_bar.cross(a_bar)),
          centripetal(body.A * body.omega_bar.cross(body.omega_bar.cross(a_bar)))
    {}
};

/// Accumulates the derivatives of terms g · a, g · ȧ and g · (ω × (ω × a)) of γ by θ and ω̄ of one body.
///
/// a = A ā is fixed in the body, and g is a global vector that is held constant. The derivatives by θ follow
/// from g · A δθ~ x̄ = δθ · (x̄ × Aᵀ g).
class GammaTerms {
public:
    GammaTerms(const Motion& body, GammaDerivatives::OfBody& sum) : body(body), sum(sum) {}

    /// Adds the derivatives of g · a.
    void a(const Vec3& a_bar, const Vec3& g) { sum.theta += a_bar.cross(body.A.transpose() * g); }
    /// Adds the derivatives of g · (ω × a).
    void adot(const Vec3& a_bar, const Vec3& g)
    {
        const Vec3 g_bar = body.A.transpose() * g;
        sum.theta += body.omega_bar.cross(a_bar).cross(g_bar);
        sum.omega += a_bar.cross(g_bar);
    }
    /// Adds the derivatives of g · (ω × (ω × a)).
    void centripetal(const Vec3& a_bar, const Vec3& g)
    {
        const Vec3 g_bar = body.A.transpose() * g, omega_a = body.omega_bar.cross(a_bar);
        sum.theta += body.omega_bar.cross(omega_a).cross(g_bar);
        sum.omega += omega_a.cross(g_bar) + a_bar.cross(g_bar.cross(body.omega_bar));
    }

private:
    const Motion& body;
    GammaDerivatives::OfBody& sum;
};

/// Pattern of a × v for arbitrary v: bit k is set if component k can differ from zero. It is clear if a is
/// zero or parallel to axis k.
inline unsigned cross_product_pattern(const Vec3& a)
{
    unsigned components = 0;
    for (int k = 0; k < 3; ++k)
        if (a[(k + 1) % 3] != 0 || a[(k + 2) % 3] != 0) components |= 1u << k;
    return components;
}

}  // namespace hilda::dae
