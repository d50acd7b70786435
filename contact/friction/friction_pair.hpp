// SPDX-License-Identifier: GPL-3.0-or-later
/// Two surfaces with friction between them, whatever it is that presses them together.

#pragma once

#include "contact/friction/friction.hpp"
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
struct ContactHistory {
    bool found = false;     ///< track has the points of the last touch, where the search begins
    bool touching = false;  ///< history and frames go on from them
    ContactFrame contact_frame = {};
    Deflections deflections = {};
};

/// What keeps two bodies apart along the normal of their contact
struct NormalSupport {
    double K = 0, D = 0;  ///< of a spring and dashpot [N/m, N s/m]
    bool rigid = false;   ///< or a constraint, and nothing moves along it
};

/// Constant; the memory belongs to who steps the bodies. See Contact for the order of a step.
class FrictionPair {
public:
    FrictionPair(std::string name, Shape i, Shape j, Inertia of_i, Inertia of_j,
                 std::shared_ptr<const FrictionModel> friction);

    /// The contact at this touch under the normal force N [N], with the motion of its point since the memory. Where N is
    /// not positive there is the touch and no more.
    ContactState contact_state(const ContactPoint& contact_point, double N, const Motion& bi,
                               const Motion& bj, const ContactHistory& history) const;
    /// From the instant of the memory to that of the meeting. Where the surfaces have parted, histories are
    /// dropped; where they meet anew, they begin at zero.
    void advance(const ContactState& now, const Motion& bi, const Motion& bj, ContactHistory& history) const;
    Wrench load(const ContactState& now, const Rates& rates, const ContactHistory& history) const
    {
        return now.N > 0 ? friction->load(now, rates, history.deflections) : Wrench();
    }

    /// The largest step [s] with which symplectic Euler is stable on the springs and dashpots of this contact, none of
    /// them slipping, with the curvatures and the normal force of this meeting. It is the h at which
    /// 4 M - 2 h D - h² K becomes singular; for one damped mode h ω = 2 (√(1 + ζ²) - ζ). A body that has more than
    /// one contact lends each an equal part of its mass: where each of them is then stable, all are together.
    ///
    /// A sphere that does not resist rolling and is held on its surface: h = (√(d² + 4 k) - d)/k with d = D q, k = K q,
    /// q = 1/m + R²/I.
    double stable_step(const ContactState& now, const NormalSupport& normal, const Motion& bi,
                       const Motion& bj, int contacts_of_i = 1, int contacts_of_j = 1) const;

    const std::string name;
    const Shape i, j;
    const Inertia of_i, of_j;
    const std::shared_ptr<const FrictionModel> friction;

protected:
    [[noreturn]] void rethrow(const lie::NumericalFailure& e) const;
    void set_fictitious(ContactState& now, const Motion& bi, const Motion& bj) const;

    double length;  ///< the smaller size of the two [m], infinite where neither has one

private:
    double m;
};

}  // namespace hilda::contact
