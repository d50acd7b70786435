// SPDX-License-Identifier: GPL-3.0-or-later
/// Interface of friction laws: state variables of a contact, friction loads, and the registry of laws.

#pragma once

#include "contact/friction/tracker.hpp"
#include "io/registry.hpp"
#include "io/schema/type_schema.hpp"

#include <limits>
#include <string>
#include <vector>

namespace hilda::dae {
class ObjectReader;
}

namespace hilda::contact {

class NormalLaw;

/// Regime of a micro-deflection: stick or slip, and whether the damper is active
struct Regime {
    bool slipping = false;  ///< true: slip (index k); false: stick (index s), the initial regime
    bool damped = true;
};

/// Friction history of a contact: the micro-deflections and their regimes. Vectors are components in (u, w)
/// of the ContactFrame.
struct Deflections {
    Vec2 S = Vec2::Zero();                                ///< sliding micro-deflection [m]
    Vec2 Theta_i = Vec2::Zero(), Theta_j = Vec2::Zero();  ///< rolling micro-deflections [rad]
    double Psi = 0;                                       ///< spinning micro-deflection [rad]
    Regime slide, roll_i, roll_j, spin;
};

/// State of a contact at one instant: the input of friction laws
struct ContactState {
    ContactPoint contact_point;
    SlidingDisplacement slip;  ///< displacement since the previous instant
    double N = 0;              ///< normal force [N]; zero or negative if there is no contact
    /// The part of a contact that this point stands for, see ManifoldPoint::share: its loads, stiffness and
    /// energy are those of a whole contact with the normal force N, times the share.
    double share = 1;
    /// Fictitious mass of the pair [kg] and its moments of inertia about the tangents and about the normal
    /// [kg m²], for the damping coefficients                                              Eqs. 4.4, 4.10
    double m = 0, I_roll = 0, I_spin = 0;
    /// Upper limit of the lever arm 1/κ of rolling friction [m]
    double max_lever = std::numeric_limits<double>::infinity();
};

/// Rates of the displacements in SlidingDisplacement, in the global frame
struct Rates {
    Vec3 s;         ///< velocity of the material of j relative to that of i, tangential [m/s]
    Vec3 p_i, p_j;  ///< velocity of the contact point relative to the material of each body [m/s]
    double psi;     ///< spin rate [rad/s]
};

/// The mean rates over a step of length h [s]: Δs/h, q_i/h, q_j/h, ψ/h
Rates mean_rates(const SlidingDisplacement& slip, double h);

/// The rates at this instant from the velocities of the bodies; the limit of the mean rates for h → 0:
///
///     ṡ = v_j(C_j) - v_i(C_i) + gap ṅ,   ṅ = ω_j × n + K_j ṗ_j              in the tangent plane
///
/// The velocity of each body is taken at its own contact point; at their mid-point there would be a false
/// slip velocity |ω gap|. The velocities of the contact point follow from Montana (1988), without charts:
///
///     (K_i + K_j) ṗ_i = (ω_i - ω_j) × n + K_j ṡ,   ṗ_j = ṗ_i - ṡ
///
/// p_i and p_j are zero if K_i + K_j is singular. For K_i = K_j = 0 the normal has the mean of both
/// rotations. Only n and u of `slip` are used.
Rates rates(const ContactPoint& contact_point, const SlidingDisplacement& slip, const Motion& bi,
            const Motion& bj);

/// Friction loads of a contact in the global frame: force F [N] on i at C and -F on j; torques T_i, T_j [N m]
struct Wrench {
    Vec3 F = Vec3::Zero(), T_i = Vec3::Zero(), T_j = Vec3::Zero();
    /// Elastic parts for output: of F [N], of the rolling torques on i and j, of the spinning torque on i
    /// about n [N m]
    Vec3 F_E = Vec3::Zero(), T_roll_E = Vec3::Zero(), T_roll_E_j = Vec3::Zero();
    double T_spin_E = 0;
    double T_spin = 0;  ///< spinning torque on i about n [N m]

    Wrench operator*(double factor) const;
};

/// Stiffness and damping of a friction law in the stick regime, for the stability limit of explicit schemes
struct Springs {
    double K_slide = 0, D_slide = 0;  ///< [N/m, N s/m]
    double K_roll = 0, D_roll = 0;    ///< [N m/rad, N m s/rad]
    double K_spin = 0, D_spin = 0;    ///< [N m/rad, N m s/rad]

    Springs operator*(double factor) const;
};

/// The springs with which a friction law holds two bodies at rest. Their forces have components in (u, w) of
/// the contact frame, or about n. A spring with K = 0 does not exist.
struct StaticSprings {
    struct Spring {
        double K = 0, bound_s = 0, bound_k = 0;  ///< stiffness; bounds of the force in stick and slip

        Spring operator*(double factor) const { return {K * factor, bound_s * factor, bound_k * factor}; }
    };
    Spring slide;  ///< F = K S on i                                                             [N/m, N]
    /// The force y = K_y κ⁻¹ Θ belongs to the torque (lever y) × n on i, with lever = κ⁻¹         [N/m, N],
    /// or the torque y × n with lever = 1                                                   [N m/rad, N m]
    Spring roll;
    Eigen::Matrix2d lever = Eigen::Matrix2d::Identity();
    Spring spin;  ///< torque -K Ψ n on i                                                  [N m/rad, N m]
};

/// Reduced mass or moment of inertia a b / (a + b), of which one may be infinite
double reduced(double a, double b);

/// Interface of a friction law. An object has no state of a contact and may be shared by many contacts.
class FrictionModel {
public:
    virtual ~FrictionModel() = default;

    /// Parameters of the tracking that the law requires
    virtual Tracking tracking() const { return {}; }
    /// Fictitious mass or moment of inertia of two bodies, of which one may be infinite
    virtual double fictitious(double a, double b) const { return reduced(a, b); }

    /// Advances the deflections from the previous instant to `now`
    virtual void advance(const ContactState& now, Deflections& deflections) const = 0;
    /// Friction loads from the deflections at `now` and the rates
    virtual Wrench load(const ContactState& now, const Rates& rates,
                        const Deflections& deflections) const = 0;
    virtual Springs springs(const ContactState& now) const = 0;
    /// The springs that are stretched at a start such that they hold bodies at rest; by default none
    virtual StaticSprings static_springs(const ContactState& /*now*/) const { return {}; }
    virtual bool needs_curvature() const { return false; }  ///< true for rolling or spinning resistance
};

/// The law without friction
std::shared_ptr<const FrictionModel> frictionless();

/// Parameters of the built-in laws; each law uses those it needs. The defaults are the balanced preset.
struct FrictionParameters {
    double mu_s = 0, mu_k = 0;  ///< static and kinetic friction coefficient, μ_s ≥ μ_k ≥ 0
    double K_E = 0;             ///< sliding stiffness [N/m]
    double zeta = 1;   ///< damping ratio ζ in D = ζ 2 √(m K)                               Eqs. 4.4, 4.10
    double eta_r = 0;  ///< rolling resistance coefficient; 0: none                                Eq. 4.6
    double eta_psi = 0;  ///< spinning resistance coefficient; 0: none                              Eq. 4.9
    double E_star = 0;  ///< effective modulus [Pa] of a Hertzian contact patch, instead of η_ψ     Sec. A.8
    bool critical_spin = false;  ///< with E_star: the torque is at most 3π/16 μ N a instead of μ N a/2
    double mu_r = 0;  ///< rolling friction coefficient of constant-torque and epsd: M_r ≤ μ_r R N

    /// Damping of sliding, rolling and spinning [N s/m, N m s/rad]; if given, it replaces the value from ζ
    std::optional<double> D_slide = {}, D_roll = {}, D_spin = {};

    Tracking tracking = {};
    bool capped = true;  ///< limit the sum of spring and damper to the static bound
    /// One relative rolling vector with opposite torques, instead of one vector per body
    bool relative_rolling = true;
    bool reduced_mass = true;  ///< fictitious mass m_i m_j / (m_i + m_j), instead of the mean
    bool static_start = true;  ///< at a start the springs hold bodies at rest, instead of being unstretched

    /// These parameters with the dissertation preset: β = 1, contact frame of body i, no limit on the damper,
    /// one rolling vector per body, mean masses, springs unstretched at a start.
    FrictionParameters as_in_dissertation() const;
    /// InvalidInput for values outside their range
    void validate() const;
};

/// A friction law. The file of the law registers it by io::Registry<FrictionLaw>::add().
struct FrictionLaw {
    std::string name, what;  ///< name in model files, one-line description
    io::TypeSchema schema = {};
    std::shared_ptr<const FrictionModel> (*make)(const FrictionParameters&) = nullptr;
    /// Reads the keys of this law alone and creates it; p contains the common keys. nullptr: the law has no
    /// keys of its own and is created by `make`. Throws dae::PlacedError.
    std::shared_ptr<const FrictionModel> (*read)(dae::ObjectReader& o, FrictionParameters p,
                                                 const NormalLaw& normal) = nullptr;
};

}  // namespace hilda::contact

extern template class hilda::io::Registry<hilda::contact::FrictionLaw>;

namespace hilda::contact {

/// For FrictionLaw::make: the constructor Law(const FrictionParameters&)
template <class Law>
std::shared_ptr<const FrictionModel> make_law(const FrictionParameters& p)
{
    return std::make_shared<Law>(p);
}
/// The law with this name; InvalidInput with the list of names if there is none
const FrictionLaw& friction_law(const std::string& name);

}  // namespace hilda::contact
