// SPDX-License-Identifier: GPL-3.0-or-later
/// Rigid contacts with Coulomb friction as a part of a multibody model (differential variational inequality).

#pragma once

#include "contact/contact_pairs.hpp"
#include "contact/detection/detector.hpp"
#include "contact/loaded_point.hpp"
#include "dae/forces/rigid_contacts.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::dae {
class Model;
}

namespace hilda::contact {

/// The law of a rigid contact: Signorini's condition with Newton's coefficient of restitution, and Coulomb's
/// law
struct RigidLaw {
    double mu_s = 0, mu_k = 0;  ///< coefficients of a contact point that sticks, that slips; mu_s ≥ mu_k ≥ 0
    double restitution = 0;     ///< in [0, 1]

    void validate() const;  ///< InvalidInput for values outside their range
};

/// The contacts of one pair of bodies, or of the pairs of a group. Each has the contact points of
/// Detector::detect_all().
class RigidContacts final : public dae::RigidContacts {
public:
    /// shape_i, shape_j: of the first and the second body of each pair. InvalidInput for a pair of surfaces
    /// without a detector.
    RigidContacts(std::string name, const dae::Model& model, ContactPairs pairs, Shape shape_i, Shape shape_j,
                  const RigidLaw& law);

    int numbers() const override { return of.numbers(); }
    void add_cones(const lie::State& x, double h, lie::ConeRows& out) const override;
    std::string name_of_pair(int number) const override;
    /// Overlaps above 1e-6 of the smaller size are refused.
    std::string start_error(const lie::State& x) const override;
    Fastest fastest(const lie::State& x) const override;

    /// Sets `out` to the contact points of a pair in the state x with the forces of the last step,
    /// x.cone_forces, and to those within a hundredth of the smaller size without a force.
    void points(const lie::State& x, int number, std::vector<LoadedPoint>& out) const;
    /// The closest points of a pair; one of them if there are several
    ContactPoint nearest(const lie::State& x, int number) const;
    const ContactPairs& pairs() const { return of; }
    /// Calls f(number) for the pairs that have a force in x.cone_forces, ascending.
    template <class F>
    void for_touching_pairs(const lie::State& x, F f) const
    {
        int last = -1;
        for (const lie::ConeForce& force : x.cone_forces) {
            const auto pair = static_cast<int>(force.key >> 32) - first_pair;
            if (pair >= numbers()) return;
            if (pair > last) f(last = pair);
        }
    }

    const std::string name;
    const Shape shape_i, shape_j;
    const RigidLaw law;

private:
    template <class Find>
    auto named(const lie::State& x, int i, int j, const Find& find) const;
    void detect(const lie::State& x, int i, int j, double reach, Manifold& out) const;
    void find_pairs(const lie::State& x, double h, std::vector<int>& numbers) const;

    const dae::Model& model;
    const ContactPairs of;
    const std::unique_ptr<const Detector> detector;
    double size = 0;              ///< smaller size of the surfaces [m], 1 if they have none
    double reach_i = 0, reach_j;  ///< see reach_about_centre()
};

}  // namespace hilda::contact
