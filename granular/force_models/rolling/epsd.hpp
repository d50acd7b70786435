// SPDX-License-Identifier: GPL-3.0-or-later
/// A torsional spring and dashpot between bodies that roll on each other.                Fang (2022), Sec. 2.2.1.4

#pragma once

#include "granular/force_models/tangential/spring.hpp"

namespace hilda::granular {

///     M_k ← M_k - h k_r ω_r,  |M_k| ≤ μ_r R* |F_n|;    k_r = k_t R*²
///     M = M_k - C_r ω_r,  C_r = 2 η_r √(I_r k_r);      without the dashpot where M_k is at its bound
///
/// ω_r is the relative turning without its part along n, and I_r = 7/5 m* R*² that of spheres about their contact.
struct Epsd {
    static constexpr const char* name = "epsd";

    float mu_r = 0, eta_r = 0;

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>& t, const NormalForce<R>& p, R k_t,
                               History<R>& history) const
    {
        const R k_r = k_t * t.R_eff * t.R_eff, bound = mu_r * t.R_eff * abs(p.F);
        const Vec<R> omega_r = t.omega - t.omega.dot(t.n) * t.n;
        const Vec<R> psi = carried(history.psi, t.n) + R(t.h) * omega_r;
        const R size = k_r * psi.norm();
        const Mask<R> full = size > bound;
        history.psi = select(full, bound / larger(size, R(tiny)), R(1.f)) * psi;
        const R I_r = Number<R>(1.4) * t.m_eff * t.R_eff * t.R_eff;
        const R C = select(full, R(0.f), 2 * eta_r * sqrt(I_r * k_r));
        return -(k_r * history.psi) - C * omega_r;
    }

    template <class Keys>
    static Epsd read(Keys& keys)
    {
        return {.mu_r = keys.not_negative("mu_r"), .eta_r = keys.not_negative("eta_r")};
    }
};

}  // namespace hilda::granular
