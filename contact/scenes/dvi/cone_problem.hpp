// SPDX-License-Identifier: GPL-3.0-or-later
/// Impulses of rigid contacts with friction, as the minimum of a quadratic function over cones.

#pragma once

#include "contact/scenes/dvi/cone.hpp"

#include <vector>

namespace hilda::contact {

/// Cone complementarity problem (Anitescu and Tasora 2010): impulses γ_c = (γ_n, γ_u, γ_w) [N s] on body i of every
/// contact, -γ_c on body j, of which
///
///     minimise  ½ γᵀ N γ + rᵀ γ,   γ_c ∈ K_c = {|γ_t| ≤ μ_c γ_n},        N = Dᵀ M⁻¹ D
///
/// The gradient u = N γ + r is what γ makes of the relative velocities r of the contact points [m/s]. At the minimum
///
///     γ_c ∈ K_c,   u_c ∈ K_c* = {u_n ≥ μ_c |u_t|},   γ_c · u_c = 0
///
/// the convex relaxation of Coulomb's law: a contact that slides is lifted at u_n = μ |u_t|. The law itself is u_c +
/// μ_c |u_t| e_n ∈ K_c* instead; see ConeSolver::solve_coulomb(). N is never formed: D hands impulses to bodies, Dᵀ
/// velocities to contacts.
struct ConeProblem {
    /// Zero for what does not move, or does not turn
    struct Body {
        double m_inverse = 0;           ///< [1/kg]
        Mat3 J_inverse = Mat3::Zero();  ///< A J̄⁻¹ Aᵀ, global axes [1/(kg m²)]
    };
    struct ContactPair {
        int i, j;
        Mat3 frame;     ///< columns (n, u, w), global; n into body i
        Vec3 s_i, s_j;  ///< from the centres of mass to the contact, global [m]
        double mu;
        Vec3 r;  ///< in the frame [m/s]
    };
    struct Velocity {
        Vec3 v = Vec3::Zero(), omega = Vec3::Zero();  ///< global [m/s, rad/s]
    };

    std::vector<Body> body;
    std::vector<ContactPair> contact;

    /// M⁻¹ D γ: the velocities that impulses give
    void respond(const std::vector<Vec3>& gamma, std::vector<Velocity>& out) const;
    /// Dᵀ v: the velocity of body i against body j at each contact, in its frame
    void relative(const std::vector<Velocity>& v, std::vector<Vec3>& out) const;

    /// The diagonal block N_cc [1/kg], as body i and body j add to it
    struct Block {
        Mat3 i, j;
    };
    Block block(const ContactPair& c) const;
};

}  // namespace hilda::contact
