// SPDX-License-Identifier: GPL-3.0-or-later
/// Cone complementarity problem: impulses of rigid contacts with friction as a quadratic minimisation over
/// cones.

#pragma once

#include "contact/scenes/dvi/cone.hpp"

#include <vector>

namespace hilda::contact {

/// Cone complementarity problem (Anitescu and Tasora 2010).
///
/// The unknowns are the impulses γ_c = (γ_n, γ_u, γ_w) [N s] on body i of each contact c; -γ_c acts on body
/// j. They
///
///     minimise  ½ γᵀ N γ + rᵀ γ,   γ_c ∈ K_c = {|γ_t| ≤ μ_c γ_n},        N = Dᵀ M⁻¹ D
///
/// D maps impulses to generalised momenta. N γ is the change of the relative velocities of the contact points
/// by the impulses [m/s]. r is the relative velocity without them plus the terms of gap and restitution (see
/// DviScene). With the gradient u = N γ + r the optimality conditions are
///
///     γ_c ∈ K_c,   u_c ∈ K_c* = {u_n ≥ μ_c |u_t|},   γ_c · u_c = 0
///
/// This is the convex relaxation of Coulomb's law: a sliding contact separates with u_n = μ |u_t|. Coulomb's
/// law itself has u_c + μ_c |u_t| e_n ∈ K_c* in its place; see ConeSolver::solve_coulomb(). N is not formed:
/// velocity_change() applies M⁻¹ D and relative_velocities() applies Dᵀ.
struct ConeProblem {
    /// Inverse mass and inertia; zero for a body that cannot translate or rotate
    struct Body {
        double m_inverse = 0;           ///< [1/kg]
        Mat3 J_inverse = Mat3::Zero();  ///< A J̄⁻¹ Aᵀ, global axes [1/(kg m²)]
    };
    struct ContactPair {
        int i, j;
        Mat3 frame;     ///< contact frame: columns (n, u, w) in global axes; n points into body i
        Vec3 s_i, s_j;  ///< from the centres of mass to the contact point, global axes [m]
        double mu;      ///< friction coefficient
        Vec3 r;         ///< r_c in the contact frame [m/s]
    };
    struct Velocity {
        Vec3 v = Vec3::Zero(), omega = Vec3::Zero();  ///< global axes [m/s, rad/s]
    };

    std::vector<Body> body;
    std::vector<ContactPair> contact;

    /// M⁻¹ D γ: the change of the body velocities by impulses γ
    void velocity_change(const std::vector<Vec3>& gamma, std::vector<Velocity>& out) const;
    /// Dᵀ v: the velocity of body i relative to body j at each contact, in the contact frame
    void relative_velocities(const std::vector<Velocity>& v, std::vector<Vec3>& out) const;

    /// The diagonal block N_cc [1/kg], as the contributions of body i and body j
    struct Block {
        Mat3 i, j;
    };
    Block block(const ContactPair& c) const;
};

}  // namespace hilda::contact
