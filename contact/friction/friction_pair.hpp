// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction between two surfaces for any source of the normal force (compliant law or constraint).

#pragma once

#include "contact/friction/friction.hpp"
#include "lie/check.hpp"
#include "lie/linear_springs.hpp"

namespace hilda::contact {

/// Mass m [kg] and inertia matrix [kg m², body frame] of a body in a contact; infinite for the ground
struct Inertia {
    double m = std::numeric_limits<double>::infinity();
    Mat3 J_bar = Mat3::Constant(std::numeric_limits<double>::infinity());

    bool moves() const { return std::isfinite(m); }
    bool turns() const { return std::isfinite(J_bar(0, 0)); }
    Mat3 J_bar_inverse() const;  ///< zero if the inertia is infinite
};

/// History of a contact between steps: the contact frame and the friction deflections
struct ContactHistory {
    /// contact_frame is valid: its points are the initial guess of the next detection
    bool has_points = false;
    /// The surfaces were in contact: frame and deflections are continued
    bool touching = false;
    ContactFrame contact_frame = {};
    Deflections deflections = {};
};

/// Stiffness and damping of a contact in the normal direction, for the stability limit
struct NormalSupport {
    double K = 0, D = 0;  ///< linearised normal law [N/m, N s/m]
    bool rigid = false;   ///< the normal direction is a constraint; K and D are not used
};

/// Numbers of contacts that the two bodies of a contact have, with this one. A contact point with a share
/// counts its contact 1/share times.
struct ContactCounts {
    double of_i = 1, of_j = 1;
};

/// A pair of surfaces with a friction law. The object is constant; the caller owns the ContactHistory. See
/// CompliantContact for the order of the calls in a step.
class FrictionPair {
public:
    FrictionPair(std::string name, Shape i, Shape j, Inertia inertia_i, Inertia inertia_j,
                 std::shared_ptr<const FrictionModel> friction);

    /// The state of the contact at a contact point with normal force N [N]. The sliding displacement is that
    /// since `history`. If N is not positive only contact_point and N are set.
    ContactState contact_state(const ContactPoint& contact_point, double N, const Motion& bi,
                               const Motion& bj, const ContactHistory& history) const;
    /// Advances `history` to the instant of `now`. The deflections are set to zero if the surfaces have
    /// separated, and start at zero if contact begins.
    void advance(const ContactState& now, const Motion& bi, const Motion& bj, ContactHistory& history) const;
    /// Friction loads; zero if N is not positive
    Wrench load(const ContactState& now, const Rates& rates, const ContactHistory& history) const
    {
        return now.N > 0 ? friction->load(now, rates, history.deflections) * now.share : Wrench();
    }
    /// FrictionModel::static_springs() of the share
    StaticSprings static_springs(const ContactState& now) const;

    /// The largest step [s] for which symplectic Euler is stable with the springs and dampers of this
    /// contact, all in the stick regime, for the curvatures and the normal force of `now`. It is the smallest
    /// h for which 4 M - 2 h D - h² K is singular (see lie::LinearSprings). M⁻¹ is the 6 × 6 matrix of
    /// inverse effective masses of the relative motions: sliding along u and w, approach along n, rolling
    /// about u and w, spinning about n. For one damped mode h ω = 2 (√(1 + ζ²) - ζ).
    ///
    /// The mass of a body with several contacts is divided equally among them. If each contact is stable with
    /// its share, the whole system is. Infinite if no finite step is unstable. damping_factor: see
    /// lie::damping_factor(); it multiplies D.
    ///
    /// Example: for a sphere without rolling friction held on its surface, h = (√(d² + 4 k) - d)/k,
    /// where d = D q, k = K q, q = 1/m + R²/I.
    double stable_step(const ContactState& now, const NormalSupport& normal, const Motion& bi,
                       const Motion& bj, ContactCounts contacts = {}, double damping_factor = 1) const;
    /// Whether a step h [s] is below stable_step(); much cheaper for a single h
    bool is_stable(double h, double damping_factor, const ContactState& now, const NormalSupport& normal,
                   const Motion& bi, const Motion& bj, ContactCounts contacts = {}) const;
    /// Energy of the springs of friction [J]: half the product of force and deflection of each. `load` is
    /// that of `now` and `history`.
    double elastic_energy(const ContactState& now, const Wrench& load, const ContactHistory& history) const;

    const std::string name;
    const Shape i, j;
    const Inertia inertia_i, inertia_j;
    const std::shared_ptr<const FrictionModel> friction;

protected:
    /// Throws e again with the name of the contact in front of the message
    [[noreturn]] void rethrow(const lie::NumericalFailure& e) const;
    /// Sets m, I_roll, I_spin and max_lever of `now`
    void set_fictitious_inertia(ContactState& now, const Motion& bi, const Motion& bj) const;

    /// Springs of sliding along u and w, approach along n, rolling about u and w, and spinning about n
    lie::LinearSprings<6> linear_springs(const ContactState& now, const Springs& springs,
                                         const NormalSupport& normal, const Motion& bi, const Motion& bj,
                                         ContactCounts contacts) const;

    double smaller_size;  ///< smaller size of the two surfaces [m]; infinite if neither has one

private:
    double j_i, j_j;  ///< largest eigenvalues of the J̄⁻¹ of both bodies [1/(kg m²)]; 0 for the ground
    double m;         ///< fictitious mass [kg]
};

}  // namespace hilda::contact
