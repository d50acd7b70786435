// SPDX-License-Identifier: GPL-3.0-or-later
/// One pair of surfaces that can touch: where, how hard, with what friction.

#pragma once

#include "contact/friction/friction_pair.hpp"
#include "contact/normal/normal_law.hpp"

namespace hilda::contact {

/// Constant; the memory belongs to who steps the bodies. A step has the order
///
///     Meeting now = contact.meet(bi, bj, memory);     // touch, normal force, motion of the contact point
///     contact.advance(now, bi, bj, memory);           // histories, once per accepted step
///     Wrench w = contact.load(now, rates, memory);    // friction, on top of the normal force N n
class CompliantContact : public FrictionPair {
public:
    /// InvalidInput for surfaces that have no single touch.
    CompliantContact(std::string name, Shape i, Shape j, Inertia of_i, Inertia of_j,
                     std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    /// lie::NumericalFailure "contact_not_converged" with the name of the contact, where no touch is found.
    ContactState evaluate(const Motion& bi, const Motion& bj, const ContactHistory& history) const;

    /// Why a run cannot begin here: a ball larger than its bowl, an overlap above a tenth of a radius of curvature or of
    /// the size of a surface; or an empty text. lie::NumericalFailure where the search for the touch fails.
    std::string objection(const Motion& bi, const Motion& bj) const;

    /// The largest step [s] with which symplectic Euler is stable: FrictionPair::stable_step with the springs of the
    /// normal law
    double stable_step(const ContactState& now, const Motion& bi, const Motion& bj, int contacts_of_i = 1,
                       int contacts_of_j = 1) const;

    /// The meeting of these surfaces when they will press hardest: what they approach with, and what a fall through
    /// their gap and overlap adds under a weight [N] that may rest on them, has gone into the spring of the normal law.
    /// An estimate, of two bodies without joints; for stable_step() at a start.
    ContactState hardest(const Motion& bi, const Motion& bj, const ContactHistory& history,
                         double weight) const;

    /// Whether they touch or are about to: nearer than a millionth of their size
    bool close(const Motion& bi, const Motion& bj, const ContactHistory& history) const;

    /// In the spring of the normal law [J]
    double energy(const ContactState& now, const Motion& bi, const Motion& bj) const
    {
        return law->energy(normal_input(now.contact_point, bi, bj));
    }

    const std::shared_ptr<const NormalLaw> law;

private:
    NormalInput normal_input(const ContactPoint& contact_point, const Motion& bi, const Motion& bj) const;
    ContactPoint find(const Motion& bi, const Motion& bj, const ContactHistory& history) const;
    ContactState without_slip(const ContactPoint& contact_point, const Motion& bi, const Motion& bj) const;

    std::unique_ptr<const Detector> detector;
    double m_normal;
};

}  // namespace hilda::contact
