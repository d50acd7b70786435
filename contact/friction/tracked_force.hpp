// SPDX-License-Identifier: GPL-3.0-or-later
/// A force between two bodies that remembers how their contact point has moved.       Fang (2022), Secs. 4.2, 4.3

#pragma once

#include "contact/friction/friction_pair.hpp"
#include "dae/model.hpp"

namespace hilda::contact {

/// Friction on body i at C, the opposite on body j, and what presses them together where that is a load. What the contact
/// remembers is in the state: the track, the histories and the instant t_n that they belong to in State::remembered,
/// what sticks and what slips in State::memory. It changes when a step is accepted.
///
/// The loads of a state x are a function of x alone: those of the histories carried on from t_n to the pose of x,
/// with dashpots by the velocities of x. In x(t_n) itself they are the histories as they stand: a contact that slips
/// sits exactly at its bound, and to carry it on by rounding would let it stick, and switch its dashpot on.
class TrackedForce : public dae::Force {
public:
    void add(const lie::State& x, lie::Loads& out) const override;

    int discrete_states() const override { return 1; }
    int internal_states() const override;
    void update_internal_state(lie::State& x) const override;

    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }
    std::string in_words() const override { return "contact '" + name + "'"; }

    /// What it remembers in x
    ContactHistory recall(const lie::State& x) const;
    /// The contact at x, with the histories carried on to it
    struct Instant {
        ContactState contact_state;
        ContactHistory history;
        bool is_saved =
            false;  ///< x is that of the memory itself, as it was when the step to it was accepted
    };
    Instant at(const lie::State& x) const;
    Wrench friction(const lie::State& x) const;  ///< for figures
    /// Whether there is anything of it at present
    virtual bool works(const lie::State&) const { return true; }
    /// The constraint that is the normal force of the same contact; nullptr where there is none
    virtual const dae::Constraint* held_by() const { return nullptr; }

    const int i, j;

protected:
    TrackedForce(const std::string& name, const dae::Model& model, int i, int j);

    virtual const FrictionPair& pair() const = 0;
    /// Touch, normal force, and motion of the contact point since the memory
    virtual ContactState evaluate(const lie::State& x, const ContactHistory& history) const = 0;
    /// That the dashpots go by: at this instant, from the velocities of the bodies
    virtual Rates speeds(const Instant& now, const lie::State& x) const;
    /// Whether the normal force is a load; else a constraint has it
    virtual bool presses() const = 0;
    /// Whether the bodies of another contact touch, or are about to
    virtual bool close(const lie::State& x) const = 0;

    /// How many contacts of a body touch at x, this one among them
    int contacts_of(int body, const lie::State& x) const;
    /// Throws what went wrong in `x`, with the bodies and the time.
    [[noreturn]] void rethrow(const lie::NumericalFailure& e, const lie::State& x) const;

    static Inertia inertia(const dae::Model& model, int b);

    void keep(const Instant& now, lie::State& x) const;
    double time_of_history(const lie::State& x) const;  ///< t_n [s]

    const dae::Model& model;

private:
    Wrench load(const Instant& now, const lie::State& x) const;

    const std::string name_i, name_j;
};

}  // namespace hilda::contact
