// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction that is solved for together with the step, so that no stiffness bounds the step.

#pragma once

namespace hilda::contact {

/// The springs and dashpots of Fang (2022), Sec. 4.3, taken at the end of a step instead of at its beginning, as rows of an
/// EvolvingContact that give way (lie::Rows::Compliant):
///
///     λ   = K_E (S + h ṡ) + K_D ṡ,            ṡ = Tᵀ (v_i - v_j) at C          |λ| ≤ μ F_N
///     λ_R = 4 η_r K_E (Z + h ż) + D_R ż,      ż = Tᵀ (K_i + K_j)⁻¹ n_i × (ω_i - ω_j)      |λ_R| ≤ 2 η_r μ F_N
///
/// -T λ acts on the material points in contact. ż is the velocity with which the contact point wanders over the bodies while
/// they roll, and Z its way, |Z| = |(K_i + K_j)⁻¹ Θ| of slide-roll-spin: the same spring and the same bound, without a
/// preferred direction. Rolling is tested against its bound first. Of λ at its bound the spring has what it would have if
/// spring and dashpot were in series with a slider,
///
///     S ← S + h (λ - K_E S)/(K_D + h K_E)
///
/// and μ is μ_s for what sticks, μ_k for what slipped in the step before. F_N is that of the step. For K_E → ∞ within its
/// bound it is ideal rolling, and then as good as the scheme: 4.0e-5 m in the bowl of Sec. 5.5.2 after 3 s with rA-half-1-kick
/// at h = 1e-2, a quarter of it at half the step. Else it is of first order, and damps. It stands over any step.
struct ImplicitFriction {
    double mu_s = 0, mu_k = 0;  ///< μ_s ≥ μ_k ≥ 0
    double K_E = 0;             ///< [N/m]
    double K_D = 0;             ///< [N s/m]
    double eta_r = 0;           ///< rolling resistance; 0: none                                     Eq. 4.5
    double D_roll = 0;          ///< D_R (1/κ)², with the mean κ of both directions [N m s/rad]

    bool resists_rolling() const { return eta_r > 0; }
    /// InvalidInput for values that are none
    void validate() const;
};

}  // namespace hilda::contact
