// SPDX-License-Identifier: GPL-3.0-or-later
/// Displacement of a contact point relative to the two bodies during a step.      Fang (2022), Secs. 4.2, A.6

#pragma once

#include "contact/detection/detector.hpp"

namespace hilda::contact {

using Vec2 = Eigen::Vector2d;

/// The tracked frame of a contact at one instant, in the body frames of i and j: contact points c [m], normal
/// n, and first tangent vector u of the contact frame (n, u, w = n × u). The friction histories are
/// components in (u, w).
struct ContactFrame {
    Vec3 c_i, c_j, n_i, n_j, u_i, u_j;
};

/// How the contact frame rotates about n during relative spinning of the two bodies
enum class Carrier {
    mid,  ///< with the mean of both bodies: the loads do not depend on which body is called i
    i     ///< with body i, as in the dissertation
};

/// Parameters of the tracking of a contact point
struct Tracking {
    /// β: fraction of the spin angle ψ by which p_i and p_j are rotated relative to each other before the
    /// difference is taken (counter-spin). Both are evaluated at t_1, but on average half of the spin takes
    /// place after a point of the path was in contact. Therefore only β = ½ is consistent to second order: a
    /// sphere of radius R that rolls with ω_t and spins with ω_n has a false slip of (½ - β) h² R ω_t ω_n per
    /// step. The dissertation has β = 1.
    double beta = 0.5;
    Carrier carrier = Carrier::mid;
};

/// Displacement of the contact point from t_0 to t_1. Vectors are in the global frame at t_1; all except n
/// are tangential.
struct SlidingDisplacement {
    Vec3 n;         ///< unit normal, into body i
    Vec3 u;         ///< first tangent vector of the contact frame (n, u, n × u)
    Vec3 u_i, u_j;  ///< u of t_0, transported with body i and with body j
    double psi;     ///< rotation of body i relative to body j about n [rad]; h (ω_i - ω_j)·n for h → 0
    Vec3 p_i, p_j;  ///< displacement of the contact point relative to the material of each body [m]
    Vec3 q_i, q_j;  ///< p_i and p_j after the counter-spin rotation [m]
    /// Δs = q_i - q_j (Eq. 4.1): displacement of the material of j relative to that of i [m]. For h → 0 it is
    /// h (v_j - v_i)_t.
    Vec3 ds;
};

/// The tangent vector v rotated about the unit normal n by the angle with this cosine and sine
inline Vec3 rotated(const Vec3& v, const Vec3& n, double cosine, double sine)
{
    return cosine * v + sine * n.cross(v);
}

/// The tangent vector with the components c in (u, n × u), and the components of a tangent vector v
inline Vec3 tangent(const Vec2& c, const Vec3& n, const Vec3& u) { return c[0] * u + c[1] * n.cross(u); }
inline Vec2 components(const Vec3& v, const Vec3& n, const Vec3& u) { return {u.dot(v), n.cross(u).dot(v)}; }

/// The contact frame at a contact point with first tangent vector u (global), expressed in both body frames.
/// For a new contact u may be any unit tangent vector; the loads do not depend on the choice.
ContactFrame contact_frame(const ContactPoint& contact_point, const Vec3& u, const Motion& bi,
                           const Motion& bj);

/// The zero displacement of a new contact, with the unit tangent vector u (global)
SlidingDisplacement zero_displacement(const ContactPoint& contact_point, const Vec3& u);

/// The displacement from the contact frame at t_0 to the contact point at t_1, for bodies at the poses bi, bj
/// of t_1.
///
/// The tangent vectors are transported by the smallest rotation of the normal. It is the maximum of f(θ) in
/// Sec. A.6 in closed form. p_b points from the present position of the old contact point of body b to the
/// new one. It is projected onto the tangent plane and scaled to the length of the path along the surface
/// (Fig. 4.2; Surface::arc).
///
/// lie::NumericalFailure "contact_not_converged" if the normal rotates by more than about 172° in the step.
SlidingDisplacement track_contact_point(const ContactFrame& from, const ContactPoint& to, const Shape& i,
                                        const Shape& j, const Motion& bi, const Motion& bj,
                                        const Tracking& how);

}  // namespace hilda::contact
