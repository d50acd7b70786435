// SPDX-License-Identifier: GPL-3.0-or-later
/// Impacts in closed form: a ball that bounces on a plane until it lies, a free flight that lands, two balls that meet.

#pragma once

#include "lie/state.hpp"

#include <optional>
#include <utility>

namespace hilda::reference {

using lie::Mat3;
using lie::Motion;
using lie::Vec3;

/// A body in free flight: r = r_0 + v_0 t + g t²/2. ω̄ is constant for a ball.
struct Flight {
    Vec3 r = Vec3::Zero(), rdot = Vec3::Zero();  ///< at t = 0 [m, m/s]
    Vec3 gravity = Vec3(0, 0, -9.81);            ///< [m/s²]

    Vec3 at(double t) const;
    Vec3 velocity(double t) const;
    /// First t > 0 at which n·r falls to d, n a unit vector [s]: a ball of radius R lands on the plane n·r = d - R.
    /// None when it never does.
    std::optional<double> lands(const Vec3& n, double d) const;
};

/// A ball without friction that falls on a plane and loses 1 - e of its normal velocity at each impact (Newton).
///
/// With the gap s = n·r - R, its rate ṡ and the fall a = -n·g, the impacts and the velocities after them are
///
///     t_1 = (ṡ_0 + w)/a,  w = √(ṡ_0² + 2 a s_0),    w_k = eᵏ w
///     t_{k+1} = t_k + 2 eᵏ w/a,    t_∞ = t_1 + 2 (w/a) e/(1 - e)
///
/// and after t_∞ the ball lies and slides. Along the plane nothing but gravity acts.
struct BouncingBall {
    Vec3 n = Vec3::UnitZ();                         ///< unit normal of the plane through the origin
    double R = 0.5, e = 0.5;                        ///< of the ball [m]; 0 ≤ e ≤ 1
    Vec3 r = Vec3(0, 0, 1.5), rdot = Vec3::Zero();  ///< centre at t = 0 [m, m/s], not in the plane
    Vec3 gravity = Vec3(0, 0, -9.81);               ///< [m/s²], towards the plane
    double m = 1;                                   ///< [kg]

    /// k-th impact, k ≥ 1 [s]; and where they end, infinite for e = 1
    double impact(int k) const;
    double comes_to_rest() const;
    /// ∫ F_N dt of the k-th impact [N s]
    double impulse(int k) const;
    /// r, ṙ, r̈ at t ≥ 0; at an impact, those after it
    Motion at(double t) const;

    /// What lies presses [N]
    double resting_force() const { return -m * n.dot(gravity); }
};

/// Two balls in one gravity that meet, without friction, with the restitution e along the line of centres.
///
///     |Δr + Δv t| = R_1 + R_2,  n from 1 to 2 then;  m_1 m_2/(m_1 + m_2) (1 + e) (-n·Δv) is the impulse
struct TwoBalls {
    struct Ball {
        double R = 0.5, m = 1;  ///< [m, kg]
        Vec3 r = Vec3::Zero(), rdot = Vec3::Zero();
    };
    Ball one, two;
    double e = 1;
    Vec3 gravity = Vec3::Zero();

    /// [s]; none when they miss each other
    std::optional<double> meet() const;
    /// From one to two, at that time
    Vec3 normal() const;
    double impulse() const;  ///< [N s], zero when they miss
    /// r, ṙ, r̈ of both at t ≥ 0; at the impact, those after it
    std::pair<Motion, Motion> at(double t) const;
};

}  // namespace hilda::reference
