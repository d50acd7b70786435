// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the schemes in the joint coordinates of a tree.

#pragma once

#include "lie/steps/node_step.hpp"
#include "lie/tree/articulated_bodies.hpp"
#include "lie/tree/joint_coordinates.hpp"

namespace hilda::lie {

/// The equations of motion in the coordinates and rates (u, w) of the joints, without constraints:
///
///     u̇ = w  or  J_r(u)⁻¹ w,    ẇ = q̈(u, w, t)                                        JointCoordinates
///
/// with q̈ from ArticulatedBodies. It has the functions of LocalCoordinateStep. The constraints are satisfied
/// up to rounding at each stage, and nothing is projected. The multipliers follow from the saddle system of
/// the node.
class TreeStep : public NodeStep {
public:
    /// Throws InvalidInput if the system is not a tree.
    TreeStep(const System& model, const Settings& settings);

    void set_multipliers(State& node) override;

protected:
    /// Number of the variables (u, w)
    int variables() const { return 2 * freedoms; }
    /// Makes x_n the origin of the variables, and the stage.
    void begin_stages();
    /// slope = d/dt (u, w) of the stage that place() and set_accelerations() have set
    void set_slope(const State& x, Eigen::Ref<Eigen::VectorXd> slope) const;
    /// The poses and velocities of x are those of x_n changed by d, the increments of (u, w).
    void place(State& x, const Eigen::VectorXd& d);
    /// Square of the Euclidean norm of an error of the variables as one of (r, θ, ṙ, ω̄) of the bodies,
    /// divided by their tolerances
    double square_over(const Eigen::VectorXd& tolerance, const Eigen::VectorXd& error);

    void assemble_once(const State&) {}
    /// r̈ and ω̄̇
    void set_accelerations(State& x);
    /// The end of a step: accelerations, and multipliers if the settings ask for them. Returns 0.
    int finish(State& x, const std::string& scheme);

    Eigen::VectorXd w_n, u, w, wdot;  ///< rates of x_n; coordinates, rates and their derivatives of the stage

private:
    JointCoordinates coordinates;
    ArticulatedBodies articulated;

protected:
    const int freedoms;

private:
    Eigen::VectorXd of_bodies;  ///< an error of (r, θ, ṙ, ω̄)
};

}  // namespace hilda::lie
