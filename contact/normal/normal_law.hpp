// SPDX-License-Identifier: GPL-3.0-or-later
/// How hard two surfaces press on each other.                                        Fang (2022), Eqs. 2.41, 2.42

#pragma once

#include "contact/detection/detector.hpp"

namespace hilda::contact {

/// What a normal law sees of a touch
struct NormalInput {
    double overlap;       ///< δ = -gap [m]
    double overlap_rate;  ///< δ̇ [m/s]
    double curvature;  ///< κ_i + κ_j [1/m], each the mean over the directions: 1/R of the effective radius
    double m;          ///< effective mass of the pair, m_i m_j / (m_i + m_j) [kg]
};

class NormalLaw {
public:
    virtual ~NormalLaw() = default;

    /// N [N]; zero or less where the surfaces do not touch
    virtual double force(const NormalInput& p) const = 0;
    /// ∂N/∂δ and ∂N/∂δ̇ [N/m, N s/m], for the stability bound
    virtual double stiffness(const NormalInput&) const { return 0; }
    virtual double damping(const NormalInput&) const { return 0; }
    /// What the spring has taken up, ∫ N dδ without damping [J]; zero for a law that has no spring
    virtual double energy(const NormalInput&) const { return 0; }
    virtual bool needs_curvature() const { return false; }  ///< a radius to press on
};

/// N is known, such as m g cos α: the surfaces are held together.
class GivenForce final : public NormalLaw {
public:
    explicit GivenForce(double N);

    double force(const NormalInput&) const override { return N; }

private:
    double N;
};

/// N = k δ + c δ̇ while δ > 0, never a pull                                                           Eq. 2.41
class Hooke final : public NormalLaw {
public:
    Hooke(double stiffness, double damping);
    /// c = 2 ζ √(m k) with the ζ of damping_ratio(): two bodies of effective mass m part at `restitution`, in [0, 1], of
    /// the speed at which they met. m is that of the pair, or the one given.
    static Hooke rebounding(double stiffness, double restitution, double m = 0);

    double force(const NormalInput& p) const override;
    double stiffness(const NormalInput&) const override { return k; }
    double damping(const NormalInput& p) const override;
    /// k δ²/2
    double energy(const NormalInput& p) const override
    {
        return p.overlap > 0 ? 0.5 * k * p.overlap * p.overlap : 0;
    }

private:
    double k, c;
    double zeta = 0, m = 0;
};

/// N = k δ^(3/2) + c δ̇, never a pull, with k = 4/3 E* √R and c = 2 √(5/6) ζ √(S m), S = 2 E* √(R δ)     Eqs. 2.42, A.23
///
/// 1/E* = Σ (1 - ν²)/E over the two bodies; m is the effective mass of the pair, or the one given. With this
/// c, δ^(5/4) moves as the overlap of a linear spring does, so ζ follows from the restitution in the same way and
/// does not depend on the speed (Antypov and Elliott 2011).
class Hertz final : public NormalLaw {
public:
    explicit Hertz(double E_star, double restitution = 1, double m = 0);
    /// ζ = -ln e / √(π² + ln² e), as contact codes have it: exact for a dashpot that pulls before the bodies part. As none
    /// does, they part a little faster: at 0.55 instead of 0.5.
    static Hertz of_free_oscillation(double E_star, double restitution, double m = 0);

    double force(const NormalInput& p) const override;
    double stiffness(const NormalInput& p) const override;
    double damping(const NormalInput& p) const override;
    /// 2/5 k δ^(5/2)
    double energy(const NormalInput& p) const override
    {
        return p.overlap > 0 ? 4. / 15 * stiffness(p) * p.overlap * p.overlap : 0;
    }
    bool needs_curvature() const override { return true; }

    const double E_star;  ///< [Pa]

private:
    double zeta, m;
};

/// ζ of a linear spring and dashpot that pushes but never pulls, so that the bodies part when the force is zero:
///
///     e = exp(-2 ζ acos ζ / √(1 - ζ²)),   with acosh and √(ζ² - 1) beyond 1        Schwager and Pöschel (2007)
double damping_ratio(double restitution);

/// E* of two materials with Young's moduli E [Pa] and Poisson ratios ν
double effective_modulus(double E_i, double nu_i, double E_j, double nu_j);

}  // namespace hilda::contact
