// SPDX-License-Identifier: GPL-3.0-or-later
/// The motion of a contact point over two bodies during a step.                     Fang (2022), Secs. 4.2, A.6

#pragma once

#include "contact/detection/detector.hpp"

namespace hilda::contact {

using Vec2 = Eigen::Vector2d;

/// What is kept of a contact from one instant to the next, each vector in the frame of its body: the contact
/// points, the normal, and the first tangent vector of the frame (n, u, w = n × u) that carries the histories.
struct ContactFrame {
    Vec3 c_i, c_j, n_i, n_j, u_i, u_j;
};

/// Which body's material the histories go with while the two bodies spin against each other
enum class Carrier {
    mid,  ///< half with each: loads do not depend on which body is called i
    i     ///< the dissertation's choice
};

struct Tracking {
    /// Part of the spin angle by which p_j is turned back before it is compared with p_i. Both are seen at t_1,
    /// after their bodies have turned, while on average half of the spin came after the point was laid down: only ½
    /// is consistent to second order. A ball that rolls and pivots shows a false slip of (½ - β) h² R ω_t ω_n a step.
    double beta = 0.5;
    Carrier carrier = Carrier::mid;
};

/// How the contact point moved from t_0 to t_1. Vectors are global, at t_1; all but n lie in the tangent plane.
struct SlidingDisplacement {
    Vec3 n;         ///< unit normal, into body i
    Vec3 u;         ///< the frame (n, u, n × u) that carries the histories
    Vec3 u_i, u_j;  ///< u of t_0 carried along by each body alone
    double psi;     ///< turn of body i against body j about n [rad]; h (ω_i - ω_j)·n in the limit
    Vec3 p_i, p_j;  ///< displacement of the contact point over the material of each body [m], as at t_1
    Vec3 q_i, q_j;  ///< the same, turned back by their parts of the spin
    /// q_i - q_j: displacement of the material of j against that of i [m], h (v_j - v_i)_t in the limit      (4.1)
    Vec3 ds;
};

/// A tangent vector turned about the unit normal n by an angle with this cosine and sine.
inline Vec3 turned(const Vec3& v, const Vec3& n, double cosine, double sine)
{
    return cosine * v + sine * n.cross(v);
}

/// A vector by its components in (u, n × u), and back
inline Vec3 tangent(const Vec2& c, const Vec3& n, const Vec3& u) { return c[0] * u + c[1] * n.cross(u); }
inline Vec2 components(const Vec3& v, const Vec3& n, const Vec3& u) { return {u.dot(v), n.cross(u).dot(v)}; }

/// The track of a contact at t_1 with u in both bodies. For a new contact u may be any tangent vector.
ContactFrame contact_frame(const ContactPoint& contact_point, const Vec3& u, const Motion& bi,
                           const Motion& bj);

/// No motion yet: the slip of a new contact, with any unit tangent u.
SlidingDisplacement no_slip(const ContactPoint& contact_point, const Vec3& u);

/// From the track at t_0 to the touch at t_1. The frames follow the normal by the smallest rotation, which is the
/// minimum of (A.6) in closed form; p_b is the way from where the old contact point of body b went to the
/// new one, put into the tangent plane at its length along the surface of the body (Fig. 4.2).
/// lie::NumericalFailure where a normal has turned round within the step.
SlidingDisplacement follow(const ContactFrame& from, const ContactPoint& to, const Shape& i, const Shape& j,
                           const Motion& bi, const Motion& bj, const Tracking& how);

}  // namespace hilda::contact
