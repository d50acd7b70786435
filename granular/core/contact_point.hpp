// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact kinematics, contact history and normal force, as used by the force laws.   Fang (2022), Sec. 2.2.1

#pragma once

#include "granular/backend/real.hpp"

namespace hilda::granular {

/// Kinematics of the contact of body i with body j.                      Fang (2022), Eqs. 2.37 to 2.40, 2.43
///
///     n = (r_i - r_j)/|r_i - r_j|,    v_n = -(v_i - v_j) . n
///     v_t = (v_i - v_j) + v_n n - (R_i omega_i + R_j omega_j) x n
///
/// Vectors are in the global frame. The normal and the relative velocities are opposite to those of Eqs. 2.38
/// and 2.40: the normal points from j to i, and velocities are of i relative to j. The lever arm of the
/// tangential force is the radius, from which the overlap is not subtracted, unless the law has
/// Lever::contact; see arm_rates(). For a boundary as body j, R_j = 0 and R* is
/// effective_radius().
template <class R>
struct ContactPoint {
    R delta;         ///< overlap [m], positive
    R R_i, R_j;      ///< radii [m]
    R R_eff, m_eff;  ///< R* = R_i R_j/(R_i + R_j) [m], m* = m_i m_j/(m_i + m_j) [kg]
    Vec<R> n;        ///< unit normal, from j to i
    R v_n;           ///< rate of the overlap dδ/dt [m/s]; positive while the bodies approach
    Vec<R> v_t;      ///< tangential velocity of the surface of i relative to that of j [m/s]
    Vec<R> omega;    ///< ω_i - ω_j [rad/s]
    Number<R> h;     ///< step size [s]
};

/// Lever arms of the tangential force
enum class Lever : int {
    radius,   ///< the radii R_i and R_j
    contact,  ///< (1 - q) R_i and (1 - q) R_j; see lever_reduction()
};

/// The part q of the radii by which Lever::contact reduces the lever arms, so that the force acts on both
/// bodies at one point within the overlap:
///
///     q = δ/(R_i + R_j),    q = δ/(2 R_i) against a boundary
///
/// The lever arm is R - δ/2 between particles of equal radii and against a boundary. The sum of the lever
/// arms is the distance of the centres: a common rotation of a pair is no sliding, and the angular momentum
/// of a pair is conserved.
template <class R>
HILDA_HD inline R lever_reduction(const ContactPoint<R>& contact)
{
    return contact.delta / (contact.R_i + select(contact.R_j > R(0.f), contact.R_j, contact.R_i));
}

/// Velocity of the surfaces that the rotations cause [m/s], without the cross product with n: l_i ω_i + l_j
/// ω_j with the lever arms l. With Lever::contact the velocity of a boundary is that of its point at the
/// depth δ/2 below the surface.
template <class R>
HILDA_HD inline Vec<R> arm_rates(const ContactPoint<R>& contact, const Vec<R>& omega_i, const Vec<R>& omega_j,
                                 Lever lever)
{
    const Vec<R> of_radii = contact.R_i * omega_i + contact.R_j * omega_j;
    if (lever == Lever::radius) return of_radii;
    const R q = lever_reduction(contact),
            depth_j = q * select(contact.R_j > R(0.f), contact.R_j, contact.R_i);
    return of_radii - (q * contact.R_i * omega_i + depth_j * omega_j);
}

/// Internal state of a contact, advanced once per step. All entries are zero when the contact begins.
template <class R>
struct History {
    Vec<R> u;      ///< tangential displacement [m]; `mindlin-incremental` stores its elastic force [N]
    R age;         ///< time since the contact began [s]
    Vec<R> psi;    ///< rolling displacement [rad]
    R spin;        ///< angle of relative rotation about n [rad]
    Mask<R> slid;  ///< whether the contact was sliding in the previous step

    // Internal variables of the laws with internal_variables = true. They are stored only if a law of the
    // world uses them.
    R largest_overlap = R(0.f);  ///< of `walton-braun` [m]
    R turning = R(0.f);          ///< of `mindlin-deresiewicz`: force of the last reversal [N]
    R amplitude = R(0.f);        ///< of `mindlin-deresiewicz`: largest force of first loading [N]
    R reference_force = R(0.f);  ///< of `mindlin-deresiewicz`: normal force of the state [N], with a sign
};

/// Result of a normal force law
template <class R>
struct NormalForce {
    R F;  ///< component along n of the force on body i [N]; negative if damping makes it tensile
    /// Factor of the tangential stiffness and damping: √(R* δ) [m] of the Hertzian laws, √(δ/R) of
    /// `scaled-hooke`, 1 of the linear laws
    R scale;
    Number<R> power = 0;  ///< exponent a of scale ∝ δ^a
};

}  // namespace hilda::granular
