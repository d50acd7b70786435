// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces and motion of the contacts of a model, for output.

#pragma once

#include "contact/rigid/rigid_contacts.hpp"
#include "dae/model.hpp"
#include "run/columns/contact_rows.hpp"

#include <string>
#include <vector>

namespace hilda::run {

/// A contact at one instant. All vectors are in the global frame. A rigid contact of several points has the
/// sum of their normal forces, its direction, the point where it acts, and the smallest gap.
struct ContactOutput {
    double F_N = 0;                   ///< normal force [N]; positive in compression
    double gap = 0;                   ///< distance of the surfaces [m], negative for an overlap
    lie::Vec3 C = lie::Vec3::Zero();  ///< contact point [m]
    lie::Vec3 n = lie::Vec3::Zero();  ///< unit normal, pointing into body i
    lie::Vec3 F = lie::Vec3::Zero();  ///< friction force on body i [N]
    lie::Vec3 T = lie::Vec3::Zero();  ///< friction torque on body i about C: rolling and spinning [N m]
    double slip = 0;                  ///< tangential speed of body j relative to body i at C [m/s]
    bool is_touching = false;         ///< the compliant contact has a normal force, the constraint is active
    bool slipping = false;            ///< the sliding spring is at its bound
    bool rolling = false;             ///< the rolling spring is at its bound; with ideal rolling always
};

/// The contacts of a model: compliant contacts that are not part of a large group, then contact constraints
/// with their friction and fallback, then the near pairs of large groups.
/// The model must outlive this object.
class ContactOutputs {
public:
    explicit ContactOutputs(const dae::Model& model);

    /// Groups with more pairs in all have no columns in tables.
    static constexpr long most_pairs_with_columns = 100000;
    /// The same for a group of rigid contacts, each of whose pairs is detected for a row
    static constexpr long most_rigid_pairs_with_columns = 1000;

    struct Contact {
        std::string name;
        int i, j;  ///< bodies
        contact::Shape shape_i, shape_j;

        /// The ContactForce of the contact, or the fallback of the constraint; or the ManifoldForce
        const dae::Force* compliant = nullptr;
        const contact::EvolvingContact* constraint = nullptr;
        const contact::EvolvingFriction* friction = nullptr;  ///< of the constraint
        const contact::RigidContacts* rigid = nullptr;
        int pair = 0;  ///< of `rigid`
    };
    std::vector<Contact> contacts;  ///< without those of groups, see near_contacts()

    /// Contact k in the state x. lie::NumericalFailure if the contact point is not found.
    ContactOutput at(size_t k, const lie::State& x) const;
    /// Calls f(number, body i, output) for the contacts of groups whose bodies are close to each other in x.
    /// The numbers follow those of `contacts`.
    template <class F>
    void near_contacts(const lie::State& x, F f) const
    {
        model.near_forces().visit(x, [&](const dae::Force& force, int number) {
            f(contacts.size() + static_cast<size_t>(number), force.bodies()[0], of(force, x));
        });
        for (const auto& [rigid, first] : rigid_groups)
            rigid->for_touching_pairs(x, [&, first = first, rigid = rigid](int pair) {
                f(contacts.size() + first + static_cast<size_t>(pair), rigid->pairs().pair(pair).first,
                  of(*rigid, pair, x));
            });
    }
    /// `force` is a ContactForce or a ManifoldForce.
    static ContactOutput of(const dae::Force& force, const lie::State& x);
    static ContactOutput of(const contact::RigidContacts& contacts, int pair, const lie::State& x);

private:
    void add_rigid(const contact::RigidContacts& of, size_t& others);
    ContactOutput of_constraint(const Contact& c, const lie::State& x) const;

    const dae::Model& model;
    mutable dae::Constraint::Derivatives derivatives;
    /// Groups of rigid contacts without columns, with the number of their first pair after `contacts`
    std::vector<std::pair<const contact::RigidContacts*, size_t>> rigid_groups;
};

}  // namespace hilda::run
