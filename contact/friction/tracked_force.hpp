// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact force of a model with friction from the tracked contact point.         Fang (2022), Secs. 4.2, 4.3

#pragma once

#include "contact/friction/friction_pair.hpp"
#include "dae/force.hpp"

namespace hilda::dae {
class Constraint;
class Model;
}  // namespace hilda::dae

namespace hilda::contact {

/// Friction on body i at C and the opposite on body j, with the normal force if that is a load and not a
/// constraint. Contact frame, deflections and their time t_n are stored in State::internal_state, the regimes
/// (stick or slip) in State::discrete_state. Both change only when a step is accepted.
///
/// The loads of a state x are a function of x alone: the deflections are advanced from t_n to the pose of x,
/// and the dampers use the velocities of x. If x is the state of t_n itself, the stored deflections are used
/// without advancing them. A slipping contact is exactly at its bound; advancing it by a rounding error could
/// change its regime to stick and activate its damper.
class TrackedForce : public dae::Force {
public:
    void add(const lie::State& x, lie::Loads& out) const override;

    int discrete_states() const override { return 1; }
    int internal_states() const override;
    bool is_passive() const override { return true; }
    void update_internal_state(lie::State& x) const override;

    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }
    std::string label() const override { return "contact '" + name + "'"; }

    /// Near: is_near_contact(). Touching: without detection, is_touching()
    bool is_counted(const lie::State& x, Counted which) const override;
    double stable_step(const lie::State& x,
                       lie::LoadEvaluation evaluation = lie::LoadEvaluation::at_step) const final;

    int max_static_springs() const override { return 3; }
    int static_springs(const lie::State& x, StaticSpring* out) const override;
    void set_static_forces(lie::State& x, const StaticForce* forces) const override;

    /// Of the surfaces and the friction law
    void check_derivatives(const lie::State& x, dae::DerivativeFindings& out) const override;

    /// The contact history stored in x
    ContactHistory saved_history(const lie::State& x) const;
    /// State of the contact at x, and the history advanced to x
    struct Instant {
        ContactState contact_state;
        ContactHistory history;
        /// x is the state at which the history was stored; the history is then not advanced
        bool is_saved = false;
    };
    Instant at(const lie::State& x) const { return at(x, evaluate(x), saved_history(x)); }
    /// Whether the bodies were in contact at the node of the history in x
    bool is_touching(const lie::State& x) const;
    double internal_energy(const lie::State& x) const override;
    /// Friction loads at x, for output; zero while the force is not applied. `now` is at(x).
    Wrench friction(const Instant& now, const lie::State& x) const;
    Wrench friction(const lie::State& x) const;
    /// False if the force is currently not applied, for example a fallback while its constraint is active
    virtual bool is_active(const lie::State&) const { return true; }
    /// The constraint that supplies the normal force of the same contact, or for which this force is the
    /// fallback; nullptr if there is none
    virtual const dae::Constraint* normal_constraint() const { return nullptr; }

    const FrictionModel& law() const;  ///< the friction law

    /// Throws e again with the names of the bodies and the time of x appended
    [[noreturn]] void rethrow(const lie::NumericalFailure& e, const lie::State& x) const;
    /// Mass and inertia of body b of the model; infinite for the ground
    static Inertia inertia(const dae::Model& model, int b);

    const int i, j;

protected:
    TrackedForce(const std::string& name, const dae::Model& model, int i, int j);

    virtual const FrictionPair& pair() const = 0;
    /// Contact point, normal force and sliding displacement since the saved history, without its name in an
    /// error
    ContactState evaluate(const lie::State& x) const;
    /// at(x) with the result of evaluate() for this history
    Instant at(const lie::State& x, const ContactState& now, const ContactHistory& history) const;
    // The functions of a Force, with `now` = at(x)
    void add(const Instant& now, const lie::State& x, lie::Loads& out) const;
    double internal_energy(const Instant& now, const lie::State& x) const;
    int static_springs(const Instant& now, const lie::State& x, StaticSpring* out) const;
    void set_static_forces(Instant now, lie::State& x, const StaticForce* forces) const;

    /// Index of the history in State::internal_state
    virtual int first_of_history() const { return first_internal_state; }
    /// The flags of the history in x, 0 before the first contact
    virtual int flags(const lie::State& x) const;
    virtual void set_flags(int flags, lie::State& x) const;
    /// Contact point, normal force and sliding displacement since `history`
    virtual ContactState evaluate(const lie::State& x, const ContactHistory& history) const = 0;
    /// Rates for the dampers. Default: the rates at this instant from the velocities of the bodies, see
    /// rates().
    virtual Rates damper_rates(const Instant& now, const lie::State& x) const;
    /// The state in which the friction law is compared with differences
    virtual ContactState loaded_state(const lie::State& x) const { return at(x).contact_state; }
    /// True if the normal force is part of this load; false if a constraint supplies it
    virtual bool applies_normal_force() const = 0;
    /// True if the bodies are in contact or close to it; used to count the contacts of a body
    virtual bool is_near_contact(const lie::State& x) const = 0;

    /// Numbers of contacts of both bodies that count in x, with this one, from those of all bodies
    /// (dae::Model::count_contacts()). The ground counts as a body with one contact.
    ContactCounts contacts(const lie::State& x, Counted which, std::span<const int> of_body) const;
    /// Stores the history of `now` in x
    virtual void save(const Instant& now, lie::State& x) const;
    double time_of_history(const lie::State& x) const;  ///< time t_n of the stored history [s]

    const dae::Model& model;

private:
    Wrench load(const Instant& now, const lie::State& x) const;

    const std::string name_i, name_j;
};

}  // namespace hilda::contact
