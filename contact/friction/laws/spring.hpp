// SPDX-License-Identifier: GPL-3.0-or-later
/// Bounded spring-damper used for sliding, rolling and spinning friction.             Fang (2022), Sec. 4.3.1

#pragma once

#include "contact/friction/friction.hpp"

namespace hilda::contact {

/// Euclidean norm or absolute value
inline double magnitude(const Vec2& v) { return v.norm(); }
inline double magnitude(double v) { return std::abs(v); }
inline double magnitude(const Vec3& v) { return v.norm(); }

/// Applies the bound to a micro-deflection H after an increment, and updates its regime.
///
/// Stick: if `length` exceeds cap_s, H is scaled to cap_s and the regime becomes slip. Slip: if `length`
/// exceeds cap_k, H is scaled to cap_k; otherwise the regime becomes stick. The damper is off in the step in
/// which H is scaled. The sign of a scalar H is preserved; the dissertation's Ψ = S_ψ loses it. `length` is
/// the measure of H that is compared with the bound. The second function uses |H|.
template <class Deflection>
void return_to_bound(Deflection& H, double length, Regime& regime, double cap_s, double cap_k)
{
    const double cap = regime.slipping ? cap_k : cap_s;
    const bool beyond = length > cap;
    if (beyond) H *= cap / length;
    regime = {.slipping = beyond, .damped = !beyond};
}
template <class Deflection>
void return_to_bound(Deflection& H, Regime& regime, double cap_s, double cap_k)
{
    return_to_bound(H, magnitude(H), regime, cap_s, cap_k);
}

/// Sum of the spring load and the damper load. If `capped`, its magnitude is limited to `bound`.
template <class Load>
Load sum_within_bound(const Load& elastic, const Load& damping, double bound, bool capped)
{
    Load sum = elastic + damping;
    if (capped)
        if (const double length = magnitude(sum); length > bound) sum *= bound / length;
    return sum;
}

/// Sliding friction of Sec. 4.3.1: base class of the built-in laws, which add rolling and spinning friction.
class SlidingFriction : public FrictionModel {
public:
    Tracking tracking() const final { return p.tracking; }
    /// Reduced mass, or the mean of Eqs. 4.4 and 4.10. If one is infinite, the other.
    double fictitious(double a, double b) const final
    {
        if (p.reduced_mass || !std::isfinite(a) || !std::isfinite(b)) return reduced(a, b);
        return 0.5 * (a + b);
    }

    const FrictionParameters p;

    StaticSprings static_springs(const ContactState& now) const final
    {
        StaticSprings all;
        if (!p.static_start) return all;
        all.slide = {.K = p.K_E, .bound_s = p.mu_s * now.N, .bound_k = p.mu_k * now.N};
        add_static_rotation(now, all);
        return all;
    }

protected:
    explicit SlidingFriction(const FrictionParameters& p) : p(p) { p.validate(); }

    /// Adds the springs of rolling and spinning to those that hold bodies at rest.
    virtual void add_static_rotation(const ContactState& /*now*/, StaticSprings& /*all*/) const {}

    /// S ← S + Δs with |S| ≤ μ N / K_E                                                                Eq. 4.1
    void advance_sliding(const ContactState& now, Deflections& deflections) const
    {
        const Vec3& n = now.slip.n;
        deflections.S += components(now.slip.ds, n, now.slip.u);
        return_to_bound(deflections.S, deflections.slide, p.mu_s * now.N / p.K_E, p.mu_k * now.N / p.K_E);
    }

    /// F = K_E S + D ṡ                                                                               Eq. 4.2
    void add_sliding(const ContactState& now, const Rates& rates, const Deflections& deflections,
                     Wrench& out) const
    {
        out.F_E = p.K_E * tangent(deflections.S, now.slip.n, now.slip.u);
        const Vec3 damping = deflections.slide.damped ? Vec3(D_slide(now) * rates.s) : Vec3(Vec3::Zero());
        out.F = sum_within_bound(out.F_E, damping, p.mu_s * now.N, p.capped);
    }

    /// D = ζ 2 √(m K_E) [N s/m], unless given                                                         Eq. 4.4
    double D_slide(const ContactState& now) const
    {
        return p.D_slide.value_or(2 * p.zeta * std::sqrt(now.m * p.K_E));
    }
};

}  // namespace hilda::contact
