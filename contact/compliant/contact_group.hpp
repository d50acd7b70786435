// SPDX-License-Identifier: GPL-3.0-or-later
/// Compliant contacts between the bodies of a group.

#pragma once

#include "contact/contact_pairs.hpp"
#include "contact/friction/friction.hpp"
#include "contact/normal/normal_law.hpp"
#include "dae/forces/force_group.hpp"

#include <atomic>

namespace hilda::contact {

/// The compliant contact of two bodies: a ManifoldForce of surfaces with several contact points, otherwise a
/// ContactForce. InvalidInput as their constructors.
std::unique_ptr<dae::Force> compliant_contact(const std::string& name, const dae::Model& model, int i,
                                              const Shape& shape_i, int j, const Shape& shape_j,
                                              std::shared_ptr<const NormalLaw> law,
                                              std::shared_ptr<const FrictionModel> friction);

/// The pairs of bodies of an element of "contacts" as a dae::ForceGroup: a compliant_contact() exists for
/// each pair whose bounding spheres are close to each other. A plane of the ground has no bounding sphere;
/// its pairs are near if the bounding sphere of the other body is close to the plane.
class ContactGroup final : public dae::ForceGroup {
public:
    /// shape_i, shape_j: of the first and the second body of each pair. InvalidInput for a pair of surfaces
    /// without a detector.
    ContactGroup(std::string name, const dae::Model& model, ContactPairs pairs, Shape shape_i, Shape shape_j,
                 std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    int numbers() const override { return of.numbers(); }
    long pairs() const override { return of.count(); }
    bool has_pair(int number) const override { return of.has(number); }
    std::array<int, 2> bodies(int number) const override;
    std::unique_ptr<dae::Force> force(int number) const override;
    const dae::Force& example() const override { return *first_force; }
    double reach(int body) const override;
    void find(const std::vector<Motion>& body, std::span<const double> motion,
              std::vector<int>& numbers) const override;

    const std::string name;
    const Shape shape_i, shape_j;
    const std::vector<int>& first_bodies() const { return of.first; }
    const std::vector<int>& second_bodies() const { return of.second; }

    /// Whether a normal law may be that of a group: it has no force while the surfaces are apart.
    static bool may_have(const NormalLaw& law);

    mutable std::atomic<long> tests = 0;  ///< distances computed by find(), for tests of growth

private:
    const dae::Model& model;
    const ContactPairs of;
    const std::shared_ptr<const NormalLaw> law;
    const std::shared_ptr<const FrictionModel> friction;
    std::unique_ptr<const dae::Force> first_force;
};

}  // namespace hilda::contact
