// SPDX-License-Identifier: GPL-3.0-or-later
/// Normal force laws of compliant contacts.                                      Fang (2022), Eqs. 2.41, 2.42

#pragma once

#include "contact/detection/detector.hpp"
#include "io/registry.hpp"
#include "io/schema/type_schema.hpp"

#include <memory>
#include <optional>

namespace hilda::dae {
class ObjectReader;
}

namespace hilda::contact {

/// Input of a normal law
struct NormalInput {
    double overlap;       ///< δ = -gap [m]
    double overlap_rate;  ///< δ̇ = n · (v_j - v_i) at C [m/s]
    double curvature;     ///< sum of the mean curvatures κ_i + κ_j = 1/R, with the effective radius R [1/m]
    double m;             ///< effective mass of the pair, m_i m_j / (m_i + m_j) [kg]
};

/// Interface of a normal law N(δ, δ̇)
class NormalLaw {
public:
    virtual ~NormalLaw() = default;

    /// N [N]. Zero or negative means no contact: the contact then has no loads.
    virtual double force(const NormalInput& p) const = 0;
    /// ∂N/∂δ [N/m] and ∂N/∂δ̇ [N s/m], for the stability limit
    virtual double stiffness(const NormalInput&) const { return 0; }
    virtual double damping(const NormalInput&) const { return 0; }
    /// Elastic energy ∫ N dδ without damping [J]; zero for a law without a spring
    virtual double energy(const NormalInput&) const { return 0; }
    virtual bool needs_curvature() const { return false; }  ///< true if force() depends on the curvature
    /// Effective modulus E* [Pa] of the bodies, for laws that know it
    virtual std::optional<double> modulus() const { return {}; }
};

/// A normal law of model files. The file of the law registers it by io::Registry<NormalLawType>::add().
struct NormalLawType {
    std::string name;  ///< value of the key "type"
    io::TypeSchema schema;
    /// Reads the keys of the law. Throws dae::PlacedError.
    std::shared_ptr<const NormalLaw> (*read)(dae::ObjectReader& o);
    bool elastic = true;  ///< has a stiffness, so that it can be the fallback of a constraint
};

/// Prescribed normal force, independent of the overlap, such as m g cos α. No stiffness, no energy.
class GivenForce final : public NormalLaw {
public:
    /// N [N]. InvalidInput if negative.
    explicit GivenForce(double N);

    double force(const NormalInput&) const override { return N; }

private:
    double N;
};

/// Linear spring-damper (Hooke): N = k δ + c δ̇ for δ > 0. A negative N is treated as no contact.    Eq. 2.41
class Hooke final : public NormalLaw {
public:
    /// k [N/m] > 0 and c [N s/m] ≥ 0, otherwise InvalidInput
    Hooke(double stiffness, double damping);
    /// c = 2 ζ √(m k) with ζ = damping_ratio(restitution): the relative speed of two bodies after the impact
    /// is `restitution`, in [0, 1], times that before. m [kg] is the effective mass; 0 means that of the
    /// pair.
    static Hooke with_restitution(double stiffness, double restitution, double m = 0);

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

/// Hertzian contact with damping:                                                             Eqs. 2.42, A.23
///
///     N = k δ^(3/2) + c δ̇  for δ > 0,   k = 4/3 E* √R,   c = 2 √(5/6) ζ √(S m),   S = 2 E* √(R δ)
///
/// 1/E* = Σ (1 - ν²)/E over the two bodies. m is the effective mass; 0 means that of the pair. A negative N
/// is treated as no contact. With this c, δ^(5/4) obeys the equation of a linear spring-damper with the same
/// ζ. The coefficient of restitution is therefore independent of the speed, and ζ =
/// damping_ratio(restitution) (Antypov and Elliott 2011).
class Hertz final : public NormalLaw {
public:
    /// E* [Pa] > 0, restitution in [0, 1], m [kg] ≥ 0, otherwise InvalidInput
    explicit Hertz(double E_star, double restitution = 1, double m = 0);
    /// With ζ = -ln e / √(π² + ln² e), as in other contact codes. This value is exact if the damper may pull
    /// before the bodies separate. Since a negative N is not applied, the rebound is faster: 0.55 for e =
    /// 0.5.
    static Hertz of_free_oscillation(double E_star, double restitution, double m = 0);

    double force(const NormalInput& p) const override;
    double stiffness(const NormalInput& p) const override;
    double damping(const NormalInput& p) const override;
    /// 2/5 k δ^(5/2) [J]
    double energy(const NormalInput& p) const override
    {
        return p.overlap > 0 ? 4. / 15 * stiffness(p) * p.overlap * p.overlap : 0;
    }
    bool needs_curvature() const override { return true; }
    std::optional<double> modulus() const override { return E_star; }

private:
    double E_star, zeta, m;
};

/// Damping ratio ζ of a linear spring-damper with N ≥ 0 for a coefficient of restitution e. The bodies
/// separate when the force is zero:
///
///     e = exp(-2 ζ acos ζ / √(1 - ζ²)),   with acosh and √(ζ² - 1) for ζ > 1     Schwager and Pöschel (2007)
///
/// Solved for ζ by bisection. e below 1e-6 is replaced by 1e-6. InvalidInput unless e is in [0, 1].
double damping_ratio(double restitution);

/// Effective modulus E* [Pa] of two materials, 1/E* = (1 - ν_i²)/E_i + (1 - ν_j²)/E_j, with Young's moduli E
/// [Pa] > 0 and Poisson's ratios ν in (-1, 0.5], otherwise InvalidInput
double effective_modulus(double E_i, double nu_i, double E_j, double nu_j);

}  // namespace hilda::contact
