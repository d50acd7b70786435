// SPDX-License-Identifier: GPL-3.0-or-later
/// Parameters of implicit friction: springs and dampers at the end of the step, which do not limit the step.

#pragma once

namespace hilda::contact {

/// Friction of Fang (2022), Sec. 4.3, with springs and dampers evaluated at the end of the step.
///
/// The friction is a set of regularised velocity rows of an EvolvingContact (lie::BoundedPair): one
/// pair for sliding and, if η_r > 0, one pair for rolling.
///
///     λ   = K_E (S + h ṡ) + K_D ṡ,              ṡ = T'ᵀ (v_i - v_j) at C                 |λ| ≤ μ F_N
///     λ_R = 4 η_r K_E (Z + h ż) + D_z ż,  ż = T'ᵀ (K_i + K_j)⁻¹ n_i × (ω_i - ω_j)  |λ_R| ≤ 2 η_r μ F_N
///
/// -T' λ acts on the material point of body i, T' λ on that of body j. T' is the tangent basis of the node
/// projected on the tangent plane. ż is the velocity of the contact point over the bodies in rolling, and Z
/// its elastic displacement: |Z| = |(K_i + K_j)⁻¹ Θ| of slide-roll-spin, with the same spring and the same
/// bound but without a preferred direction. D_z = D_R κ² + D_κ κ. 1/κ is the mean of the two lever arms, the
/// eigenvalues of (K_i + K_j)⁻¹ limited to 10 L. F_N is the normal force of the same step. The rolling pair
/// is solved first (see lie::BoundedRows).
///
/// After the step the elastic displacement is updated as for a spring and a damper in series with a slider,
///
///     S ← S + h (λ - K_E S)/(K_D + h K_E)
///
/// and likewise Z. μ is μ_s for a pair that sticks and μ_k for a pair that slipped in the last step.
///
/// The rows are stable for any step size. They damp the motion and are of first order in general. For K_E → ∞
/// below the bound they become ideal rolling and have the order of the scheme: the error is 4.0e-5 m in the
/// bowl of Sec. 5.5.2 after 3 s with rA-half-1-kick at h = 1e-2 s, and a quarter of it at half the step.
struct ImplicitFriction {
    double mu_s = 0, mu_k = 0;  ///< μ_s ≥ μ_k ≥ 0
    double K_E = 0;             ///< [N/m]
    double K_D = 0;             ///< [N s/m]
    double eta_r = 0;           ///< rolling resistance; 0: none                                     Eq. 4.5
    double D_roll = 0;          ///< rotational damping D_R [N m s/rad]
    double D_kappa = 0;         ///< D_z/κ in addition [N s]: critical damping is proportional to κ
    bool static_start = true;   ///< at a start S and Z hold bodies at rest, instead of being zero

    bool has_rolling_resistance() const { return eta_r > 0; }
    /// Throws lie::InvalidInput if a parameter is out of range.
    void validate() const;
};

}  // namespace hilda::contact
