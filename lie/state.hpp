// SPDX-License-Identifier: GPL-3.0-or-later
/// What changes while a system moves.

#pragma once

#include "lie/so3.hpp"

#include <vector>

namespace hilda::lie {

/// Position, velocity and acceleration of one body: r, ṙ, r̈ of its centre of mass in the global frame [m,
/// m/s, m/s²], A from body to global, ω̄, ω̄̇ in the body frame [rad/s, rad/s²].
struct Motion {
    Vec3 r = Vec3::Zero(), rdot = Vec3::Zero(), rddot = Vec3::Zero();
    Mat3 A = Mat3::Identity();
    Vec3 omega_bar = Vec3::Zero(), omegadot_bar = Vec3::Zero();
};

/// Everything a step starts from. Two equal states continue equally.
struct State {
    double t = 0;  ///< [s]
    std::vector<Motion> body;
    Eigen::VectorXd alpha;   ///< unknowns without mass: the contact points of contacts that evolve
    Eigen::VectorXd lambda;  ///< multiplier of each constraint row
    /// Whole numbers that a system remembers from step to step: the branch of a driver, turns
    std::vector<int> discrete_state;
    /// Real numbers that it remembers: contact points, what friction has stored. Loads may depend on them; constraints
    /// may in how they are written, such as along which tangents, never in what they say.
    std::vector<double> internal_state;
    /// What a scheme carries from step to step: half-step velocities, earlier increments. Empty at a start.
    Eigen::VectorXd history;
};

/// The rotation nearest to an A that rounding has moved off SO(3), to first order in AᵀA - I (one Newton step
/// of the polar decomposition). It keeps ‖AᵀA - I‖ at a few ulp over any number of steps.
inline Mat3 orthonormalised(const Mat3& A) { return A * (1.5 * Mat3::Identity() - 0.5 * A.transpose() * A); }

}  // namespace hilda::lie
