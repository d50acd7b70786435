// SPDX-License-Identifier: GPL-3.0-or-later
/// How hard two surfaces press on each other.                                        Fang (2022), Eqs. 2.41, 2.42

#pragma once

#include "contact/detection.hpp"

namespace hilda::contact {

/// What a normal law sees of a touch
struct Pressing {
    double overlap;       ///< δ = -gap [m]
    double overlap_rate;  ///< δ̇ [m/s]
    double curvature;  ///< κ_i + κ_j [1/m], each the mean over the directions: 1/R of the effective radius
    double m;          ///< effective mass of the pair, m_i m_j / (m_i + m_j) [kg]
};

class NormalLaw {
public:
    virtual ~NormalLaw() = default;

    /// N [N]; zero or less where the surfaces do not touch
    virtual double force(const Pressing& p) const = 0;
    /// ∂N/∂δ and ∂N/∂δ̇ [N/m, N s/m], for the stability bound
    virtual double stiffness(const Pressing&) const { return 0; }
    virtual double damping(const Pressing&) const { return 0; }
};

/// N is known, such as m g cos α: the surfaces are held together.
class GivenForce final : public NormalLaw {
public:
    explicit GivenForce(double N);

    double force(const Pressing&) const override { return N; }

private:
    double N;
};

/// N = k δ + c δ̇ while δ > 0, never a pull                                                           Eq. 2.41
class Hooke final : public NormalLaw {
public:
    Hooke(double stiffness, double damping);
    /// c = 2 ζ √(m k) with the ζ that makes two bodies of effective mass m rebound at `restitution`, in [0, 1], of
    /// their speed. m is that of the pair, or the one given.
    static Hooke rebounding(double stiffness, double restitution, double m = 0);

    double force(const Pressing& p) const override;
    double stiffness(const Pressing&) const override { return k; }
    double damping(const Pressing& p) const override;

private:
    double k, c;
    double zeta = 0, m = 0;
};

/// N = k δ^(3/2) + c δ̇ with k = 4/3 E* √R and c = 2 √(5/6) β √(S m), S = 2 E* √(R δ)        Eqs. 2.42, A.23
///
/// 1/E* = Σ (1 - ν²)/E over the two bodies; β = -ln e / √(π² + ln² e) for a coefficient of restitution e in [0, 1].
/// m is the effective mass of the pair, or the one given.
class Hertz final : public NormalLaw {
public:
    explicit Hertz(double E_star, double restitution = 1, double m = 0);

    double force(const Pressing& p) const override;
    double stiffness(const Pressing& p) const override;
    double damping(const Pressing& p) const override;

private:
    double E_star, beta, m;
};

/// E* of two materials with Young's moduli E [Pa] and Poisson ratios ν
double effective_modulus(double E_i, double nu_i, double E_j, double nu_j);

}  // namespace hilda::contact
