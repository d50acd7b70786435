// SPDX-License-Identifier: GPL-3.0-or-later
/// What a friction law is to a contact: a history that it keeps, loads that it makes of it.

#pragma once

#include "contact/friction/tracker.hpp"

#include <limits>
#include <string>
#include <vector>

namespace hilda::dae {
class ObjectReader;
}

namespace hilda::contact {

class NormalLaw;

/// Whether a micro-deflection sticks or slips, and whether its dashpot works
struct Regime {
    bool slipping = false;  ///< k; sticking, s, at first
    bool damped = true;
};

/// What a contact remembers of its friction. Vectors by their components in (u, w) of the Track.
struct Deflections {
    Vec2 S = Vec2::Zero();                                ///< sliding micro-deflection [m]
    Vec2 Theta_i = Vec2::Zero(), Theta_j = Vec2::Zero();  ///< rolling micro-deflections [rad]
    double Psi = 0;                                       ///< spinning micro-deflection [rad]
    Regime slide, roll_i, roll_j, spin;
};

/// A contact at one instant, as a friction law sees it
struct ContactState {
    ContactPoint contact_point;
    SlidingDisplacement slip;  ///< since the instant before
    double N = 0;              ///< normal force [N]; not positive where the surfaces do not touch
    /// Fictitious mass and moments of inertia of the pair for the dashpots, about the tangents and about the
    /// normal [kg, kg m²]                                                                    Eqs. 4.4, 4.10
    double m = 0, I_roll = 0, I_spin = 0;
    double lever =
        std::numeric_limits<double>::infinity();  ///< the longest that 1/κ may be as a lever arm [m]
};

/// Speeds of what Slip has the displacements of
struct Rates {
    Vec3 s;         ///< of the material of j against that of i [m/s]
    Vec3 p_i, p_j;  ///< of the contact point over the material of each body [m/s]
    double psi;     ///< [rad/s]
};

/// The mean over a step of length h
Rates mean_rates(const SlidingDisplacement& slip, double h);

/// At this instant, from the velocities of the bodies, the limit of the mean rates for a small step:
///
///     ṡ = v_j(C_j) - v_i(C_i) + gap ṅ,   ṅ = ω_j × n + K_j ṗ_j              in the tangent plane
///
/// the velocity of each body at its own point: in the middle between the two there is a false slip of |ω gap|. The
/// contact point moves as Montana's equations say: (K_i + K_j) ṗ_i = (ω_i - ω_j) × n + K_j ṡ. Zero for p where K_i +
/// K_j is singular.
Rates rates(const ContactPoint& contact_point, const SlidingDisplacement& slip, const Motion& bi,
            const Motion& bj);

/// Friction on the two bodies of a contact, global: F [N] on i at C, -F on j; torques [N m]
struct Wrench {
    Vec3 F = Vec3::Zero(), T_i = Vec3::Zero(), T_j = Vec3::Zero();
    /// Elastic parts, for figures: of F [N], of the rolling torque on i and j, of the spinning torque on i [N m]
    Vec3 F_E = Vec3::Zero(), T_roll_E = Vec3::Zero(), T_roll_E_j = Vec3::Zero();
    double T_spin_E = 0;
    double T_spin = 0;
};

/// The springs and dashpots of a friction law, for the stability of an explicit step
struct Springs {
    double K_slide = 0, D_slide = 0;  ///< [N/m, N s/m]
    double K_roll = 0, D_roll = 0;    ///< [N m/rad, N m s/rad]
    double K_spin = 0, D_spin = 0;
};

/// a b / (a + b), of masses or moments of inertia, one of which may be infinite
double reduced(double a, double b);

/// Derive for a law of your own; one object may serve many contacts.
class FrictionModel {
public:
    virtual ~FrictionModel() = default;

    /// Frames and counter-spin that the law wants
    virtual Tracking tracking() const { return {}; }
    /// Fictitious mass or moment of inertia of two, one of which may be infinite
    virtual double fictitious(double a, double b) const { return reduced(a, b); }

    /// The history from the last instant to this one
    virtual void advance(const ContactState& now, Deflections& deflections) const = 0;
    /// Friction of the history it has got to
    virtual Wrench load(const ContactState& now, const Rates& rates,
                        const Deflections& deflections) const = 0;
    virtual Springs springs(const ContactState& now) const = 0;
    virtual bool needs_curvature() const { return false; }  ///< rolling or spinning that it resists
};

/// No friction at all
std::shared_ptr<const FrictionModel> frictionless();

/// What the built-in laws are told; a law takes from it what concerns it. As it stands: the balanced preset.
struct FrictionParameters {
    double mu_s = 0, mu_k = 0;  ///< μ_s ≥ μ_k ≥ 0
    double K_E = 0;             ///< sliding stiffness [N/m]
    double zeta = 1;   ///< part of the critical damping in D = ζ 2 √(m K)                  Eqs. 4.4, 4.10
    double eta_r = 0;  ///< rolling resistance; 0: none                                            Eq. 4.5
    double eta_psi = 0;  ///< spinning resistance; 0: none                                           Eq. 4.9
    double E_star = 0;   ///< effective modulus [Pa] of a Hertzian patch that resists spinning, instead  A.8
    double mu_r = 0;     ///< of constant-torque and epsd: M_r ≤ μ_r R N

    /// Dashpots of sliding, rolling and spinning [N s/m, N m s/rad], instead of those by ζ
    std::optional<double> D_slide = {}, D_roll = {}, D_spin = {};

    Tracking tracking = {};
    bool capped = true;            ///< spring and dashpot together stay within the static Coulomb bound
    bool relative_rolling = true;  ///< one rolling vector with opposite torques, not one for each body
    bool reduced_mass = true;      ///< fictitious mass: m_i m_j / (m_i + m_j), not the mean

    /// The same as the dissertation has it: counter-spin by ψ, histories with body i, dashpots beyond the bound, a
    /// rolling torque for each body, mean masses.
    FrictionParameters as_in_dissertation() const;
    /// InvalidInput for values that are none
    void validate() const;
};

/// A law as it stands in the list
struct FrictionLaw {
    std::string name, what;
    std::shared_ptr<const FrictionModel> (*make)(const FrictionParameters&) = nullptr;
    /// Reads the keys that only this law has, and makes it. In p those that all laws share have been read. Without it the
    /// law has no keys of its own. Throws dae::PlacedError.
    std::shared_ptr<const FrictionModel> (*read)(dae::ObjectReader& o, FrictionParameters p,
                                                 const NormalLaw& normal) = nullptr;
};
const std::vector<FrictionLaw>& friction_laws();
/// The law of that name; InvalidInput names those there are.
const FrictionLaw& friction_law(const std::string& name);
bool register_friction_law(FrictionLaw law);
template <class Law>
bool register_friction_law(FrictionLaw law)
{
    law.make = [](const FrictionParameters& p) -> std::shared_ptr<const FrictionModel> {
        return std::make_shared<Law>(p);
    };
    return register_friction_law(std::move(law));
}

}  // namespace hilda::contact
