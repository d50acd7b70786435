// SPDX-License-Identifier: GPL-3.0-or-later
/// Impacts in closed form: a bouncing ball, free flight to a plane, and the collision of two balls.

#pragma once

#include "lie/state.hpp"

#include <optional>
#include <utility>

namespace hilda::reference {

using lie::Mat3;
using lie::Motion;
using lie::Vec3;

/// Free flight of a body: r = r_0 + v_0 t + g t²/2. ω̄ of a ball is constant.
struct Flight {
    Vec3 r = Vec3::Zero(), rdot = Vec3::Zero();  ///< at t = 0 [m, m/s]
    Vec3 gravity = Vec3(0, 0, -9.81);            ///< [m/s²]

    Vec3 at(double t) const;        ///< position [m]
    Vec3 velocity(double t) const;  ///< [m/s]
    /// First t > 0 with n·r = d and decreasing n·r [s]; n is a unit vector. A ball of radius R lands on the
    /// plane n·r = d - R at that time. std::nullopt if there is no such time.
    std::optional<double> landing_time(const Vec3& n, double d) const;
};

/// Frictionless ball that bounces on a plane, with Newton's coefficient of restitution e.
///
/// With the gap s = n·r - R, its rate ṡ and the normal acceleration a = -n·g, impact times and normal
/// velocities are
///
///     t_1 = (ṡ_0 + w)/a,  w = √(ṡ_0² + 2 a s_0),    w_k = eᵏ w
///     t_{k+1} = t_k + 2 eᵏ w/a,    t_∞ = t_1 + 2 (w/a) e/(1 - e)
///
/// After t_∞ the ball remains on the plane and slides. The tangential acceleration is that of gravity at all
/// times. All functions but resting_force() throw lie::InvalidInput for a member or an argument outside its
/// range.
struct BouncingBall {
    Vec3 n = Vec3::UnitZ();   ///< unit normal of the plane through the origin
    double R = 0.5, e = 0.5;  ///< radius of the ball [m]; coefficient of restitution, 0 ≤ e ≤ 1
    Vec3 r = Vec3(0, 0, 1.5), rdot = Vec3::Zero();  ///< centre at t = 0 [m, m/s], gap positive
    Vec3 gravity = Vec3(0, 0, -9.81);               ///< [m/s²], with a component towards the plane
    double m = 1;                                   ///< [kg]

    /// Time of impact k [s], k ≥ 1
    double impact_time(int k) const;
    /// Time t_∞ at which the impacts end [s]; infinite for e = 1
    double rest_time() const;
    /// Normal impulse of impact k [N s], k ≥ 1
    double impulse(int k) const;
    /// r, ṙ, r̈ at t ≥ 0; at the time of an impact, the values after it
    Motion at(double t) const;

    /// Normal force after rest_time() [N]
    double resting_force() const { return -m * n.dot(gravity); }
};

/// Collision of two frictionless balls in uniform gravity, with the coefficient of restitution e along the
/// line of centres.
///
///     |Δr + Δv t| = R_1 + R_2                  time of the collision, n from ball 1 to ball 2 then
///     P = m_1 m_2/(m_1 + m_2) (1 + e) (-n·Δv)  impulse
///
/// All functions throw lie::InvalidInput for a radius or mass that is not positive, for e outside [0, 1], and
/// for balls that touch or overlap at t = 0.
struct TwoBalls {
    struct Ball {
        double R = 0.5, m = 1;                       ///< [m, kg]
        Vec3 r = Vec3::Zero(), rdot = Vec3::Zero();  ///< centre at t = 0 [m, m/s]
    };
    Ball one, two;
    double e = 1;                 ///< coefficient of restitution, 0 ≤ e ≤ 1
    Vec3 gravity = Vec3::Zero();  ///< [m/s²]

    /// Time of the collision [s]; std::nullopt if the balls miss each other
    std::optional<double> collision_time() const;
    /// Unit normal from ball 1 to ball 2 at the collision. Throws lie::NumericalFailure "no_impact" if they
    /// miss.
    Vec3 normal() const;
    double impulse() const;  ///< [N s]; 0 if the balls miss each other
    /// r, ṙ, r̈ of both balls at t ≥ 0; at the time of the collision, the values after it
    std::pair<Motion, Motion> at(double t) const;
};

}  // namespace hilda::reference
