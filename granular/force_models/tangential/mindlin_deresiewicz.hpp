// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction with partial slip in an annulus of the contact area, and hysteresis.
///
/// Mindlin and Deresiewicz, J. Appl. Mech. 20 (1953). Increments with a varying normal force: Thornton and
/// Randall, in Micromechanics of Granular Materials (1988); Vu-Quoc and Zhang, Mech. Mater. 31 (1999). The
/// displacement along the previous force in three dimensions: Walton and Braun, J. Rheol. 30 (1986).

#pragma once

#include "granular/backend/cube_root.hpp"
#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

/// The elastic force T has the stiffness K of the contact area without its slip annulus; K_0 = 8 G* a is that
/// without slip. At constant normal force N, with T* the force at the last reversal:
///
///     K = K_0 (1 - |T|/(μ N))^(1/3)             first loading, up to |T| = μ N (sliding)
///     K = K_0 (1 - |T - T*|/(2 μ N))^(1/3)      unloading and reloading, until |T| reaches the largest force
///                                               of the first loading, which then continues
///
/// A step integrates K exactly, with the N of its end. If μ N has changed by q in the step, the curve moves
/// first. σ = ±1 is the direction of the displacement s:
///
///     T ← T + σ q,   T* ← T* - σ q,   s ← s - σ q/K_0,      in increments ΔT = K s + σ q (1 - K/K_0)
///
/// The contact does not slip if K_0 |s| < q; then T ← T + K_0 s. If N decreases, the direction stays the same
/// unless K_0 |s| > |q|.
///
/// In three dimensions T is rotated into the tangent plane (to_tangent_plane()). The displacement along T
/// changes T as above, that across T with K_0, and |T| is at most μ N. The theory is that of a constant
/// direction, of the pressure of Hertz's theory and of equal materials.
///
/// Of the reversals the contact stores that of the first loading and the last one: the curves are exact for a
/// loop within the largest loop, up to an error of first order of the step over its end. A loop within that
/// one is not closed. Changes of N below 1e-6 of N accumulate before they act, because rounding errors of N
/// must not reduce T.
///
/// The dashpot γ v_t of the tangential spring is added to T, and their sum is bounded by μ N. There is one
/// coefficient of friction μ.
struct MindlinDeresiewicz {
    static constexpr const char* name = "mindlin-deresiewicz";
    static constexpr const char* description =
        "Friction with partial slip and hysteresis (Mindlin and Deresiewicz 1953): the tangential stiffness "
        "decreases to zero at the bound mu F_n in first loading, unloading and reloading. A damper is added.";
    static constexpr bool internal_variables = true;

    TangentialSpring spring = {};
    float mu = 0;  ///< coefficient of friction

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& contact, const NormalForce<R>& normal,
                               History<R>& history) const
    {
        using Scalar = Number<R>;
        const R zero(0.f), one(1.f);
        const R K_0 = spring.stiffness(normal), gamma = spring.damping(contact, normal);
        const R bound = mu * abs(normal.F);

        // T ≥ 0 is the force along e; the turning point and the direction are relative to e.
        const Vec<R> before = to_tangent_plane(history.u, contact.n);
        const Vec<R> elastic = -(R(contact.h) * K_0) * contact.v_t;  // increment without slip
        const R T = before.norm();
        const Mask<R> loaded = T > zero;
        const Vec<R> e =
            (one / larger(select(loaded, T, elastic.norm()), R(tiny))) * select(loaded, before, elastic);
        const R along = elastic.dot(e);
        const R direction = select(history.reference_force < zero, -one, one);
        const R earlier = abs(history.reference_force);
        const R change = bound - earlier;
        const R growth = select(abs(change) > Scalar(1e-6) * bound, change, zero);  // μ ΔN

        const Mask<R> reversed = direction * along < -abs(growth);
        const R sigma = select(reversed, -direction, direction), forward = sigma * along;
        const Mask<R> stuck = forward < growth;
        const R turning = select(reversed, T, history.turning);
        const Mask<R> first = sigma * T >= Scalar(0.99999) * history.amplitude;

        const R T_moved = T + sigma * growth, turning_moved = turning - sigma * growth,
                amplitude_moved = larger(history.amplitude + growth, zero);
        const R base = select(first, zero, turning_moved),
                span = larger(select(first, one, R(2.f)) * bound, R(tiny));
        // (K/K_0)³; a point behind the turning point has K_0
        const R w = smaller(larger(one - sigma * (T_moved - base) / span, zero), one);
        const R root = cube_root(w), root2 = root * root;
        const R step = smaller(Scalar(2) / 3 * larger(forward - growth, zero) / span, root2);
        const R rest2 = root2 - step, rest = sqrt(rest2);
        // span (root³ - rest³), without cancellation
        const R slipping = sigma * span * step * (root2 + root * rest + rest2) / larger(root + rest, R(tiny));
        const R T_new = select(stuck, T + along, T_moved + slipping);

        const Vec<R> raw = T_new * e + (elastic - along * e);
        const R size = raw.norm();
        const Vec<R> now = select(size > bound, bound / larger(size, R(tiny)), one) * raw;
        const R T_now = smaller(size, bound);

        // A turning point is erased if T moves back over it because N decreases.
        const R turning_now = select(stuck, turning, turning_moved),
                amplitude_now =
                    select(first, T_now, larger(select(stuck, history.amplitude, amplitude_moved), T_now));
        const R ahead = select(first | stuck, zero, sigma * (T_new - turning_now));
        const Mask<R> erased = ahead < zero;
        const R sign = select(T_new < zero, -one, one);  // e changes its sign with T
        const R direction_now = sign * select(erased, -sigma, sigma);
        history.u = now;
        history.turning = select(erased, -direction_now * amplitude_now, sign * turning_now);
        history.amplitude = amplitude_now;
        const R reference = earlier + growth;
        history.reference_force = direction_now * reference;

        const Vec<R> test = now - gamma * contact.v_t;
        const R test_size = test.norm();
        history.slid = test_size > bound;
        return select(history.slid, bound / larger(test_size, R(tiny)), one) * test;
    }

    /// Energy of the spring without slip, T²/(2 K_0) [J]; that of the contact in first loading is up to 1.2
    /// times as large.
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>&, const R& k, const History<R>& history) const
    {
        return Number<R>(0.5) * history.u.dot(history.u) / larger(k, R(tiny));
    }

    template <class Keys>
    static MindlinDeresiewicz read(Keys& keys)
    {
        return {.spring = TangentialSpring::read(keys), .mu = keys.kinetic_friction()};
    }
};

}  // namespace hilda::granular
