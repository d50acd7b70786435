// SPDX-License-Identifier: GPL-3.0-or-later
/// The spring and dashpot that sliding, rolling and spinning friction share.          Fang (2022), Sec. 4.3.1

#pragma once

#include "contact/friction/friction.hpp"

namespace hilda::contact {

inline double size(const Vec2& v) { return v.norm(); }
inline double size(double v) { return std::abs(v); }
inline double size(const Vec3& v) { return v.norm(); }

/// A micro-deflection that has grown: sticking, it gives way at cap_s and slips; slipping, it stays at cap_k until
/// it falls below and sticks again. The dashpot is off while it slips. The sign of a spin is kept, which the
/// dissertation's wording would lose.
/// `length` measures it where that is not its size.
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
    return_to_bound(H, size(H), regime, cap_s, cap_k);
}

/// Spring and dashpot, and together no more than `bound` where it is to be kept.
template <class Load>
Load within(const Load& elastic, const Load& damping, double bound, bool keep)
{
    Load sum = elastic + damping;
    if (keep)
        if (const double length = size(sum); length > bound) sum *= bound / length;
    return sum;
}

/// The built-in laws slide alike (Sec. 4.3.1) and differ in rolling and spinning.
class Sliding : public FrictionModel {
public:
    Tracking tracking() const final { return p.tracking; }
    /// Reduced, or the mean of Eqs. 4.4 and 4.10
    double fictitious(double a, double b) const final
    {
        if (p.reduced_mass || !std::isfinite(a) || !std::isfinite(b)) return reduced(a, b);
        return 0.5 * (a + b);
    }

protected:
    explicit Sliding(const FrictionParameters& p) : p(p) { p.validate(); }

    void slide(const ContactState& now, Deflections& deflections) const
    {
        const Vec3& n = now.slip.n;
        deflections.S += components(now.slip.ds, n, now.slip.u);
        return_to_bound(deflections.S, deflections.slide, p.mu_s * now.N / p.K_E, p.mu_k * now.N / p.K_E);
    }

    /// F = K_E S + D Δs/h                                                                            Eq. 4.2
    void add_sliding(const ContactState& now, const Rates& rates, const Deflections& deflections,
                     Wrench& out) const
    {
        out.F_E = p.K_E * tangent(deflections.S, now.slip.n, now.slip.u);
        const Vec3 damping = deflections.slide.damped ? Vec3(D_slide(now) * rates.s) : Vec3(Vec3::Zero());
        out.F = within(out.F_E, damping, p.mu_s * now.N, p.capped);
    }

    double D_slide(const ContactState& now) const
    {
        return p.D_slide.value_or(2 * p.zeta * std::sqrt(now.m * p.K_E));
    }

    const FrictionParameters p;
};

}  // namespace hilda::contact
