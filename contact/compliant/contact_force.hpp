// SPDX-License-Identifier: GPL-3.0-or-later
/// A contact between two bodies of a multibody model.                       Fang (2022), Secs. 4.2, 4.3

#pragma once

#include "contact/compliant/contact.hpp"
#include "contact/friction/tracked_force.hpp"

namespace hilda::contact {

/// N n and friction on body i at C, the opposite on body j, with the normal force N of a law of the overlap.
class ContactForce final : public TrackedForce {
public:
    /// Between two bodies of the model, of which one may be dae::ground. InvalidInput for a pair of surfaces that has
    /// no single touch.
    ContactForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i, int j,
                 const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                 std::shared_ptr<const FrictionModel> friction);

    /// In the normal spring; what friction holds is not counted.
    double potential_energy(const lie::State& x) const override;
    std::string objection(const lie::State& x) const override;
    /// As the contact is, or as it will be where it presses hardest: see Contact::hardest.
    double stable_step(const lie::State& x) const override;

    /// Makes it stand by for a constraint: there is nothing of it until that has handed over.
    void stand_by(const dae::Constraint& c) { replaced = &c; }
    bool works(const lie::State& x) const override
    {
        return replaced == nullptr || dae::Model::mode(*replaced, x) == dae::Constraint::fallback_active;
    }
    const dae::Constraint* held_by() const override { return replaced; }

    const CompliantContact contact;

private:
    const FrictionPair& pair() const override { return contact; }
    ContactState evaluate(const lie::State& x, const ContactHistory& history) const override;
    bool presses() const override { return true; }
    bool close(const lie::State& x) const override;

    const dae::Constraint* replaced = nullptr;
};

}  // namespace hilda::contact
