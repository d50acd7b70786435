// SPDX-License-Identifier: GPL-3.0-or-later
/// Compliant contact as a force of a multibody model.                       Fang (2022), Secs. 4.2, 4.3

#pragma once

#include "contact/compliant/compliant_force.hpp"
#include "contact/compliant/contact.hpp"
#include "contact/detection/other_points.hpp"
#include "contact/friction/tracked_force.hpp"
#include "contact/internal_state.hpp"

namespace hilda::contact {

/// Applies N n and the friction loads to body i at C and the opposite to body j. N is the force of a normal
/// law.
class ContactForce final : public TrackedForce, public CompliantForce {
public:
    /// A contact between two bodies of the model, of which one may be dae::ground. InvalidInput for a pair of
    /// surfaces that never has a single contact point.
    ContactForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i, int j,
                 const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                 std::shared_ptr<const FrictionModel> friction);

    /// Elastic energy of the normal law [J]. The energy of the friction springs is not included.
    double potential_energy(const lie::State& x) const override;
    std::string start_error(const lie::State& x) const override;
    int internal_states() const override;
    /// Stability limit [s] at the largest compression expected, see
    /// CompliantContact::state_at_largest_compression
    double stable_step_with(const lie::State& x, lie::LoadEvaluation evaluation,
                            std::span<const int> near) const override;
    bool is_stable(const lie::State& x, double h, lie::LoadEvaluation evaluation,
                   std::span<const int> touching) const override;
    /// Throws NumericalFailure "contact_missed" if the bodies pass through each other within the step.
    void check_step(const lie::State& before, const lie::State& after) const override;
    /// Of the normal law as well, at the largest compression expected
    void check_derivatives(const lie::State& x, dae::DerivativeFindings& out) const override;
    double overlap(const lie::State& x) const override;
    double relative_overlap(const lie::State& x) const override;

    /// Makes this force the fallback of constraint c: it is active only while c is in the fallback mode.
    void set_fallback_of(const dae::Constraint& c) { constraint = &c; }
    bool is_active(const lie::State& x) const override;
    const dae::Constraint* normal_constraint() const override { return constraint; }

    const CompliantContact contact;

private:
    const FrictionPair& pair() const override { return contact; }
    ContactState evaluate(const lie::State& x, const ContactHistory& history) const override;
    ContactState loaded_state(const lie::State& x) const override;
    bool applies_normal_force() const override { return true; }
    bool is_near_contact(const lie::State& x) const override;
    void save(const Instant& now, lie::State& x) const override;

    /// Internal state in addition to that of TrackedForce: the contact point of the last accepted node and
    /// the poses of the bodies there. Loads, energy and output at these poses do not detect the contact
    /// again. The poses are compared bit by bit, so the result depends on x only. A pair with a cheap
    /// detector has none: to copy it with the state takes more time. For a pair with other_points their
    /// OtherPoints::Pose follows.
    struct NodePoint {
        Vec3 r_i, r_j;
        Mat3 A_i, A_j;
        ContactPoint contact_point;

        bool is_at(const Motion& bi, const Motion& bj) const
        {
            return r_i == bi.r && r_j == bj.r && A_i == bi.A && A_j == bj.A;
        }
    };
    NodePoint saved_point(const lie::State& x) const;
    /// The contact point of the last accepted node, if x or its internal states are those of the node
    ContactPoint node_point(const lie::State& x) const;
    /// Index of NodePoint in State::internal_state
    int first_of_node_point() const { return first_internal_state + TrackedForce::internal_states(); }
    int node_point_states() const { return contact.has_cheap_detector() ? 0 : reals<NodePoint>(); }

    const std::unique_ptr<const OtherPoints> other_points;  ///< nullptr for a pair with one contact point
    const dae::Constraint* constraint = nullptr;
};

}  // namespace hilda::contact
