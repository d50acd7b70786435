// SPDX-License-Identifier: GPL-3.0-or-later
/// One scalar constraint between two bodies: the building block of joints and drivers.

#pragma once

#include "dae/body.hpp"

namespace hilda::dae {

/// δΦ = r_i · δr_i + pi_i · δπ̄_i + r_j · δr_j + pi_j · δπ̄_j
struct Variation {
    Vec3 r_i, pi_i, r_j, pi_j;
};

/// A body-fixed vector a = A ā and what carries it along: a, its rate ω × a, and the part ω × (ω × a) of its
/// second derivative that the velocities alone cause. Global frame.
struct Carried {
    Vec3 v, vdot, centripetal;

    Carried(const Motion& body, const Vec3& a_bar)
        : v(body.A * a_bar), vdot(body.A * body.omega_bar.cross(a_bar)),
          centripetal(body.A * body.omega_bar.cross(body.omega_bar.cross(a_bar)))
    {}
};

/// Which components of a × v can differ from zero, for some v: bit k is clear where a lies along axis k, or
/// is zero.
inline unsigned crossed(const Vec3& a)
{
    unsigned components = 0;
    for (int k = 0; k < 3; ++k)
        if (a[(k + 1) % 3] != 0 || a[(k + 2) % 3] != 0) components |= 1u << k;
    return components;
}

class Block {
public:
    Block(int i, int j) : i(i), j(j) {}
    virtual ~Block() = default;

    /// Φ(r, A, t)
    virtual double phi(const Motion& bi, const Motion& bj, double t) const = 0;
    /// Its first variation
    virtual Variation variation(const Motion& bi, const Motion& bj, double t) const = 0;
    /// ν = -∂Φ/∂t, so that Φ_r ṙ + Π̄ ω̄ = ν
    virtual double nu(const Motion& bi, const Motion& bj, double t) const = 0;
    /// γ with Φ_r r̈ + Π̄ ω̄̇ = γ
    virtual double gamma(const Motion& bi, const Motion& bj, double t) const = 0;

    /// Which of the twelve derivatives (r, pi of body i in bits 0–5; of body j in bits 6–11) can ever differ
    /// from zero.
    virtual unsigned nonzero() const { return 0b111111111111; }
    /// Why this block cannot be used in this position, as "what is wrong, got value"; empty when it can.
    /// Asked at the start.
    virtual std::string objection(const Motion& /*bi*/, const Motion& /*bj*/, double /*t*/) const
    {
        return {};
    }

    int i, j;  ///< body numbers, or ground
};

}  // namespace hilda::dae
