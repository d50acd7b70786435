// SPDX-License-Identifier: GPL-3.0-or-later
/// A contact between two bodies of a multibody model.                       Fang (2022), Secs. 4.2, 4.3

#pragma once

#include "contact/contact.hpp"
#include "dae/model.hpp"

namespace hilda::contact {

/// N n and friction on body i at C, the opposite on body j. What the contact remembers is in the state: the track,
/// the histories and the instant t_n that they belong to in State::remembered, what sticks and what slips in
/// State::memory. It changes when a step is accepted.
///
/// The loads of a state x are a function of x alone: those of the histories carried on from t_n to the pose of x,
/// with dashpots by the velocities of x. In x(t_n) itself they are the histories as they stand: a contact that slips
/// sits exactly at its bound, and to carry it on by rounding would let it stick, and switch its dashpot on.
class ContactForce final : public dae::Force {
public:
    /// Between two bodies of the model, of which one may be dae::ground. InvalidInput for a pair of surfaces that has
    /// no single touch.
    ContactForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i, int j,
                 const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                 std::shared_ptr<const FrictionModel> friction);

    void add(const lie::State& x, lie::Loads& out) const override;
    /// In the normal spring; what friction holds is not counted.
    double potential_energy(const lie::State& x) const override;
    std::string objection(const lie::State& x) const override;

    int memory() const override { return 1; }
    int remembered() const override;
    void remember(lie::State& x) const override;

    /// As the contact is, or as it will be where it presses hardest: see Contact::hardest.
    double stable_step(const lie::State& x) const override;

    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }
    std::string in_words() const override { return "contact '" + name + "'"; }

    /// What it remembers in x
    Memory recall(const lie::State& x) const;
    /// The contact at x, with the histories carried on to it
    struct Instant {
        Meeting meeting;
        Memory memory;
    };
    Instant at(const lie::State& x) const;
    Wrench friction(const lie::State& x) const;  ///< for figures

    /// Makes it stand by for a constraint: there is nothing of it until that has handed over.
    void stand_by(const dae::Constraint& c) { replaced = &c; }

    const int i, j;
    const Contact contact;

private:
    void keep(const Instant& now, lie::State& x) const;
    /// How many contacts of a body touch at x, this one among them
    int contacts_of(int body, const lie::State& x) const;
    /// Throws what went wrong in `x`, with the bodies and the time.
    [[noreturn]] void rethrow(const lie::NumericalFailure& e, const lie::State& x) const;

    bool works(const lie::State& x) const
    {
        return replaced == nullptr || dae::Model::mode(*replaced, x) == dae::Constraint::handed_over;
    }

    const std::string name_i, name_j;
    const dae::Model& model;
    const dae::Constraint* replaced = nullptr;
};

}  // namespace hilda::contact
