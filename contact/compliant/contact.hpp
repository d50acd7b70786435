// SPDX-License-Identifier: GPL-3.0-or-later
/// Compliant contact of one pair of surfaces: detection, normal force and friction.

#pragma once

#include "contact/detection/detector.hpp"
#include "contact/friction/friction_pair.hpp"
#include "contact/normal/normal_law.hpp"

namespace hilda::contact {

/// A pair of surfaces with a normal law and a friction law. The object is constant; the caller owns the
/// ContactHistory. The calls of a step are
///
///     ContactState now = contact.evaluate(bi, bj, history);   // contact point, N, sliding displacement
///     contact.advance(now, bi, bj, history);                  // friction history, once per accepted step
///     Wrench w = contact.load(now, rates, history);           // friction loads, see Wrench
///
/// The normal force is N n on body i and -N n on body j, in the global frame, at the point C.
class CompliantContact : public FrictionPair {
public:
    /// Throws lie::InvalidInput for a pair of shapes that make_detector() rejects.
    CompliantContact(std::string name, Shape i, Shape j, Inertia inertia_i, Inertia inertia_j,
                     std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    /// The state of the contact for the poses and velocities of bi and bj. Throws lie::NumericalFailure
    /// "contact_not_converged" with the name of the contact if no contact point is found.
    ContactState evaluate(const Motion& bi, const Motion& bj, const ContactHistory& history) const;
    /// The same for a contact point that is known for these poses
    ContactState evaluate_at(const ContactPoint& contact_point, const Motion& bi, const Motion& bj,
                             const ContactHistory& history, double share = 1) const;

    /// The same without a sliding displacement: for the stability limit
    ContactState state_without_history(const ContactPoint& contact_point, const Motion& bi, const Motion& bj,
                                       double share = 1) const;

    /// The reason why a run cannot start at these poses, or an empty text if it can. The reasons are: the
    /// contact point is not unique; one surface does not fit into the other; a law needs a positive curvature
    /// and the surfaces have none; the overlap exceeds a tenth of the radius of curvature or of the size of a
    /// surface, whichever is smaller. Throws lie::NumericalFailure if the search for the contact point fails.
    std::string start_error(const Motion& bi, const Motion& bj) const;

    /// Overlap relative to the smaller of the radii of curvature and sizes of both surfaces; negative for a
    /// gap
    double relative_overlap(const ContactPoint& contact_point) const;

    /// The largest step [s] for which symplectic Euler is stable: FrictionPair::stable_step() with the
    /// stiffness and damping of the normal law in the state `now`
    double stable_step(const ContactState& now, const Motion& bi, const Motion& bj,
                       ContactCounts contacts = {}, double damping_factor = 1) const;
    bool is_stable(double h, double damping_factor, const ContactState& now, const Motion& bi,
                   const Motion& bj, ContactCounts contacts = {}) const;

    /// Estimate of the contact state at the largest compression expected after this start, for stable_step().
    ///
    /// At this compression the spring of the normal law stores its present energy, the kinetic energy of the
    /// approach, and the work of the force `weight` [N] over the gap and the compression. The bodies are
    /// treated as free, without joints. The normal force is that for zero velocities. For a law without a
    /// spring the overlap is the present one.
    ContactState state_at_largest_compression(const Motion& bi, const Motion& bj,
                                              const ContactHistory& history, double weight) const;

    /// Distance of the surfaces [m], negative for an overlap
    double gap(const Motion& bi, const Motion& bj, const ContactHistory& history) const
    {
        return detect(bi, bj, history).gap;
    }
    /// The contact point at these poses. lie::NumericalFailure as evaluate()
    ContactPoint contact_point(const Motion& bi, const Motion& bj, const ContactHistory& history) const
    {
        return detect(bi, bj, history);
    }
    /// Detector::detect_all() with the name of the contact in an error
    void contact_points(const Motion& bi, const Motion& bj, double reach, Manifold& out) const;
    bool has_cheap_detector() const { return detector->is_cheap(); }  ///< see Detector::is_cheap()
    double smaller_of_sizes() const { return smaller_size; }          ///< of the two surfaces [m]

    double nearly_touching() const;  ///< the largest gap of is_near_contact() [m]
    /// Whether the gap is at most 1e-6 times the smaller size of the surfaces
    bool is_near_contact(const Motion& bi, const Motion& bj, const ContactHistory& history) const;

    /// Elastic energy of the normal law [J]
    double energy(const ContactState& now, const Motion& bi, const Motion& bj) const
    {
        return now.share * law->energy(normal_input(now.contact_point, bi, bj));
    }

    const std::shared_ptr<const NormalLaw> law;

    /// Input of the normal law at a contact point
    NormalInput normal_input(const ContactPoint& contact_point, const Motion& bi, const Motion& bj) const;

private:
    NormalSupport normal_support(const ContactState& now, const Motion& bi, const Motion& bj) const;
    ContactPoint detect(const Motion& bi, const Motion& bj, const ContactHistory& history) const;

    std::unique_ptr<const Detector> detector;
    double m_normal;
};

}  // namespace hilda::contact
