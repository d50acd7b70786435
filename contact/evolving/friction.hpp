// SPDX-License-Identifier: GPL-3.0-or-later
/// Tracked friction as a force on an evolving contact.   Source: Fang (2022), Sec. 5.5.2

#pragma once

#include "contact/evolving/contact.hpp"
#include "contact/friction/tracked_force.hpp"
#include "dae/model.hpp"

namespace hilda::contact {

/// A friction law of Chapter 4 that acts on an evolving contact as a force.
///
/// The displacements of the contact point over the two bodies (Eq. 4.1) follow from ᾱ_i, ᾱ_j at two nodes. No
/// contact detection is needed. The force acts on the material points at C; it does not appear in the
/// equations of ᾱ.
///
/// The normal force F_N is the multiplier of the constraint at the last accepted step. It is saved among the
/// internal state variables, so that the loads are a function of the state. Half-implicit schemes find λ_n in
/// the step that leaves t_n; F_N is then that of t_{n-1}. The lag causes an error of first order in h if
/// friction is at its bound, and none if it sticks. If a change of the friction force μ F_N changes F_N by
/// more than itself (shape of the body), the lag is unstable and F_N oscillates from step to step.
///
/// The friction is zero if F_N ≤ 0 or if the contact is inactive; an inactive contact loses its histories.
/// After an impact the friction acts from the second step on, when F_N is known.
///
/// At a node the dampers use the mean rates Δs/h of the last step, as in Chapter 4. Elsewhere they use the
/// velocities of the state. The alternative, the velocities that leapfrog schemes extrapolate to t_n, was
/// rejected: the matrix whose singularity defines stable_step() becomes 4 M - 4 h D - h² K, which halves the
/// limit where damping dominates. With the mean rates, those of the middle of the last step, the limit holds
/// for all half-implicit schemes except rA-half-2. rA-half-2 and rA-rattle are stable up to three fifths of
/// it.
class EvolvingFriction final : public TrackedForce {
public:
    /// Takes the name and the bodies of a contact of this model. Throws lie::InvalidInput if the contact
    /// already has friction of its own (ideal rolling or implicit).
    EvolvingFriction(const dae::Model& model, const EvolvingContact& contact,
                     std::shared_ptr<const FrictionModel> friction);

    int internal_states() const override;
    void update_internal_state(lie::State& x) const override;
    bool internal_state_uses_multipliers() const override { return true; }

    /// Stability limit of the step [s] (see FrictionPair::stable_step) for the tangential springs; the
    /// constraint eliminates the normal direction. Infinite while the fallback replaces the contact.
    double stable_step_with(const lie::State& x, lie::LoadEvaluation evaluation,
                            std::span<const int> near) const override;
    bool is_stable(const lie::State& x, double h, lie::LoadEvaluation evaluation,
                   std::span<const int> touching) const override;

    double normal_force(const lie::State& x) const;  ///< the F_N that the friction uses [N]; 0 if inactive
    bool is_active(const lie::State& x) const override;
    const dae::Constraint* normal_constraint() const override { return &contact; }

    const EvolvingContact& contact;

private:
    const FrictionPair& pair() const override { return friction_pair; }
    ContactState evaluate(const lie::State& x, const ContactHistory& history) const override;
    bool applies_normal_force() const override { return false; }
    bool is_near_contact(const lie::State& x) const override { return is_active(x); }
    Rates damper_rates(const Instant& now, const lie::State& x) const override;
    ContactPoint contact_point(const lie::State& x) const;

    /// Internal state in addition to that of TrackedForce. Tangent vectors are stored by their components in
    /// (u, w).
    struct StepData {
        double N = 0, psi = 0;  ///< F_N [N]; mean spin rate of the last step [rad/s]
        /// Mean rates of the last step [m/s]; at a start those of the initial velocities
        Vec2 s = Vec2::Zero(), p_i = Vec2::Zero(), p_j = Vec2::Zero();
    };
    StepData last_step(const lie::State& x) const;
    void save_step(const StepData& last, lie::State& x) const;

    const FrictionPair friction_pair;
};

}  // namespace hilda::contact
