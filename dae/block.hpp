// SPDX-License-Identifier: GPL-3.0-or-later
/// One scalar constraint between two bodies: the building block of joints and drivers.

#pragma once

#include "dae/body.hpp"

namespace hilda::dae {

/// δΦ = r_i · δr_i + pi_i · δπ̄_i + r_j · δr_j + pi_j · δπ̄_j
struct Variation {
    Vec3 r_i, pi_i, r_j, pi_j;

    static Variation zero() { return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; }
};

using Mat12 = Eigen::Matrix<double, 12, 12>;

/// How γ changes: γ' = r_i · δr_i + theta_i · δθ_i + rdot_i · δṙ_i + omega_i · δω̄_i and the same for body j
struct GammaChange {
    struct Of {
        Vec3 r = Vec3::Zero(), theta = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    } i, j;
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

/// Adds up how a sum of products g · a, g · ȧ, g · (ω × (ω × a)) changes with θ and ω̄ of the body that carries
/// a, for global vectors g: A δθ̃ x̄ · g = δθ · (x̄ × Aᵀg).
class Pull {
public:
    Pull(const Motion& body, GammaChange::Of& to) : body(body), to(to) {}

    void a(const Vec3& a_bar, const Vec3& g) { to.theta += a_bar.cross(body.A.transpose() * g); }
    void adot(const Vec3& a_bar, const Vec3& g)
    {
        const Vec3 g_bar = body.A.transpose() * g;
        to.theta += body.omega_bar.cross(a_bar).cross(g_bar);
        to.omega += a_bar.cross(g_bar);
    }
    void centripetal(const Vec3& a_bar, const Vec3& g)
    {
        const Vec3 g_bar = body.A.transpose() * g, omega_a = body.omega_bar.cross(a_bar);
        to.theta += body.omega_bar.cross(omega_a).cross(g_bar);
        to.omega += omega_a.cross(g_bar) + a_bar.cross(g_bar.cross(body.omega_bar));
    }

private:
    const Motion& body;
    GammaChange::Of& to;
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

    /// ∂(r_i, pi_i, r_j, pi_j)/∂(δr_i, δθ_i, δr_j, δθ_j), A ← A exp(δθ̃). As it stands here by differences, good
    /// to about 1e-9; the same holds for the next two.
    virtual Mat12 second_variation(const Motion& bi, const Motion& bj, double t) const;
    /// ∂ν/∂(δr_i, δθ_i, δr_j, δθ_j)
    virtual Variation nu_variation(const Motion& bi, const Motion& bj, double t) const;
    virtual GammaChange gamma_variation(const Motion& bi, const Motion& bj, double t) const;

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
