// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction from the motion of the contact point, where the contact point is an unknown.   Fang (2022), Sec. 5.5.2

#pragma once

#include "contact/evolving/contact.hpp"
#include "contact/friction/tracked_force.hpp"

namespace hilda::contact {

/// The friction of Chapter 4 on a contact that evolves. The contact points ᾱ_i, ᾱ_j of two nodes are all it needs of its
/// tracking: no touch is looked for, and their ways over the two bodies are those of Eq. 4.1. It acts on the material
/// points at C, and there is nothing of it in the equations of ᾱ.
///
/// Its normal force F_N is the multiplier of the constraint as it stood when the last step was accepted, kept in
/// State::remembered so that the loads are a function of the state. Half-implicit schemes find λ_n in the step that
/// leaves t_n, so that there it is F_N of t_{n-1}. It matters where friction is at its bound, to first order in h;
/// friction that sticks does not see it. Where the body is so shaped that the friction μ F_N would change F_N by more
/// than itself, the lag does not settle and F_N swings from step to step.
///
/// Where F_N is not positive there is no friction, nor where the contact is open, which forgets the histories. After an
/// impact it begins with the second step, when F_N is known.
///
/// At a node the dashpots go by the mean speeds Δs/h of the step that led there, as in Chapter 4, and elsewhere by the
/// velocities of x. The leapfrog schemes extrapolate their velocities to t_n, which makes 4 M - 4 h D - h² K of what
/// stable_step() looks at: half the step where damping rules. The means lag by h/2, and keep the bound
/// for all half-implicit schemes but rA-half-2, which like rA-rattle stands three fifths of it.
class EvolvingFriction final : public TrackedForce {
public:
    /// For a contact of this model; it takes its name and its bodies. InvalidInput for one that rolls ideally.
    EvolvingFriction(const dae::Model& model, const EvolvingContact& contact,
                     std::shared_ptr<const FrictionModel> friction);

    int internal_states() const override;
    void update_internal_state(lie::State& x) const override;
    bool internal_state_uses_multipliers() const override { return true; }

    /// Of the springs across the normal, along which the constraint holds
    double stable_step(const lie::State& x) const override;

    double normal_force(const lie::State& x) const;  ///< that friction goes by [N]
    bool works(const lie::State& x) const override { return !dae::Model::inactive(contact, x); }
    const dae::Constraint* held_by() const override { return &contact; }

    const EvolvingContact& contact;

private:
    const FrictionPair& pair() const override { return rubbing; }
    ContactState evaluate(const lie::State& x, const ContactHistory& history) const override;
    bool presses() const override { return false; }
    bool close(const lie::State& x) const override { return works(x); }
    Rates speeds(const Instant& now, const lie::State& x) const override;
    ContactPoint contact_point(const lie::State& x) const;

    /// What it remembers besides the track and the histories: vectors by their components in (u, w)
    struct Step {
        double N = 0, psi = 0;  ///< F_N; speeds of the last step, of a start those of the start
        Vec2 s = Vec2::Zero(), p_i = Vec2::Zero(), p_j = Vec2::Zero();
    };
    Step last_step(const lie::State& x) const;
    void keep_step(const Step& last, lie::State& x) const;

    const FrictionPair rubbing;
};

}  // namespace hilda::contact
