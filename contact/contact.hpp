// SPDX-License-Identifier: GPL-3.0-or-later
/// One pair of surfaces that can touch: where, how hard, with what friction.

#pragma once

#include "contact/friction.hpp"
#include "contact/normal_law.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

/// Mass [kg] and inertia [kg m², body frame] as a contact sees them; infinite for a body that nothing moves
struct Inertia {
    double m = std::numeric_limits<double>::infinity();
    Mat3 J_bar = Mat3::Constant(std::numeric_limits<double>::infinity());

    bool moves() const { return std::isfinite(m); }
    bool turns() const { return std::isfinite(J_bar(0, 0)); }
    Mat3 J_bar_inverse() const;  ///< zero where it does not turn
};

/// What a contact keeps from step to step
struct Memory {
    bool found = false;     ///< track has the points of the last touch, where the search begins
    bool touching = false;  ///< history and frames go on from them
    Track track = {};
    History history = {};
};

/// Constant; the memory belongs to who steps the bodies. A step has the order
///
///     Meeting now = contact.meet(bi, bj, memory);     // touch, normal force, motion of the contact point
///     contact.advance(now, bi, bj, memory);           // histories, once per accepted step
///     Wrench w = contact.load(now, rates, memory);    // friction, on top of the normal force N n
class Contact {
public:
    /// InvalidInput for surfaces that have no single touch.
    Contact(std::string name, Shape i, Shape j, Inertia of_i, Inertia of_j,
            std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    /// lie::NumericalFailure "contact_not_converged" with the name of the contact, where no touch is found.
    Meeting meet(const Motion& bi, const Motion& bj, const Memory& memory) const;
    /// From the instant of the memory to that of the meeting. Where the surfaces have parted, histories are
    /// dropped; where they meet anew, they begin at zero.
    void advance(const Meeting& now, const Motion& bi, const Motion& bj, Memory& memory) const;
    Wrench load(const Meeting& now, const Rates& rates, const Memory& memory) const
    {
        return now.N > 0 ? friction->load(now, rates, memory.history) : Wrench();
    }

    /// Why a run cannot begin here: a ball larger than its bowl, an overlap above a tenth of a radius of curvature or of
    /// the size of a surface; or an empty text. lie::NumericalFailure where the search for the touch fails.
    std::string objection(const Motion& bi, const Motion& bj) const;

    /// The largest step [s] with which symplectic Euler is stable on the springs and dashpots of this contact, none of
    /// them slipping, with the curvatures and the normal force of this meeting. It is the h at which
    /// 4 M - 2 h D - h² K becomes singular; for one damped mode h ω = 2 (√(1 + ζ²) - ζ). A body that has more than
    /// one contact lends each an equal part of its mass: where each of them is then stable, all are together.
    double stable_step(const Meeting& now, const Motion& bi, const Motion& bj, int contacts_of_i = 1,
                       int contacts_of_j = 1) const;

    /// The meeting of these surfaces when they will press hardest: what they approach with, and what a fall through
    /// their gap and overlap adds under a weight [N] that may rest on them, has gone into the spring of the normal law.
    /// An estimate, of two bodies without joints; for stable_step() at a start.
    Meeting hardest(const Motion& bi, const Motion& bj, const Memory& memory, double weight) const;

    /// Whether they touch or are about to: nearer than a millionth of their size
    bool close(const Motion& bi, const Motion& bj, const Memory& memory) const;

    /// In the spring of the normal law [J]
    double energy(const Meeting& now, const Motion& bi, const Motion& bj) const
    {
        return law->energy(pressing(now.touch, bi, bj));
    }

    const std::string name;
    const Shape i, j;
    const Inertia of_i, of_j;
    const std::shared_ptr<const NormalLaw> law;
    const std::shared_ptr<const FrictionModel> friction;

private:
    Pressing pressing(const Touch& touch, const Motion& bi, const Motion& bj) const;
    [[noreturn]] void rethrow(const lie::NumericalFailure& e) const;
    Touch find(const Motion& bi, const Motion& bj, const Memory& memory) const;
    Meeting without_slip(const Touch& touch, const Motion& bi, const Motion& bj) const;
    void set_fictitious(Meeting& now, const Motion& bi, const Motion& bj) const;

    std::unique_ptr<const Detector> detector;
    double m, m_normal;
    double length;  ///< the smaller size of the two [m], infinite where neither has one
};

}  // namespace hilda::contact
