// SPDX-License-Identifier: GPL-3.0-or-later
/// The state of a mechanical system: everything that changes during a run.

#pragma once

#include "lie/cones/cone_rows.hpp"
#include "lie/so3.hpp"

#include <memory>
#include <vector>

namespace hilda::lie {

/// Lists that a system derives from the numbers of a state, such as the pairs of bodies that are close to
/// each other. They do not change once they exist, so copies of a state share them.
struct DerivedLists {
    virtual ~DerivedLists() = default;
};

/// Pose, velocity and acceleration of one body.
///
/// r, ṙ, r̈ are those of the centre of mass in the global frame [m, m/s, m/s²]. A maps body vectors to global
/// ones. ω̄, ω̄̇ have body-frame components [rad/s, rad/s²].
struct Motion {
    Vec3 r = Vec3::Zero(), rdot = Vec3::Zero(), rddot = Vec3::Zero();
    Mat3 A = Mat3::Identity();
    Vec3 omega_bar = Vec3::Zero(), omegadot_bar = Vec3::Zero();
};

/// The initial values of a step. Equal states have equal continuations, to the last digit if the pivots of
/// the linear solver are the same (Integrator::pivots).
struct State {
    double t = 0;  ///< [s]
    std::vector<Motion> body;
    Eigen::VectorXd alpha;   ///< algebraic variables, e.g. the contact points of evolving contacts
    Eigen::VectorXd lambda;  ///< multiplier of each constraint row
    /// Integer state variables of the system, constant during a step: the branch of a driver, the number of
    /// turns
    std::vector<int> discrete_state;
    /// Real state variables of the system, constant during a step: contact points, elastic displacements of
    /// friction. Loads may depend on them. The form of a constraint may depend on them (e.g. the choice of
    /// tangents), but not the set of its solutions.
    std::vector<double> internal_state;
    /// State variables of a multi-step scheme: half-step velocities, earlier increments. Empty at a start.
    Eigen::VectorXd history;
    /// Loads that are set from outside between the steps, in addition to those of the system: F [N, global
    /// frame, at the centre of mass] and n̄ [N m, body frame] of each body. They are constant during a step.
    /// Empty: none
    std::vector<double> applied_loads;
    /// The forces of the contact points of System::cones() in the step to t, in ascending order of their
    /// keys. Empty at a start and without rigid contacts
    std::vector<ConeForce> cone_forces = {};
    /// What the system derives from the other members; not part of checkpoints. Empty: the system derives it
    /// when it needs it.
    std::shared_ptr<const DerivedLists> derived = nullptr;
};

}  // namespace hilda::lie
