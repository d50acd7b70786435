// SPDX-License-Identifier: GPL-3.0-or-later
/// Accelerations of a tree of bodies, in a time proportional to the number of bodies.
///
/// Featherstone (1983), Int. J. Robotics Research 2, 13-30: the articulated-body algorithm. All vectors have
/// global components, and a body is described at the point Q of its joint: the acceleration a of Q, the
/// angular acceleration α, the force F and the moment M about Q.
///
///     (F, M) = I (a, α) + p,   I = [ A  B ; Bᵀ C ]
///
/// are the force and moment in the joint of a body that carries all bodies behind it. With the freedoms S of
/// the joint, U = I S and D = Sᵀ U, the joint accelerations are q̈ = D⁻¹ (-Sᵀ p - Uᵀ a'), where a' is the
/// acceleration for q̈ = 0. The body before then carries I - U D⁻¹ Uᵀ.

#pragma once

#include "lie/loads.hpp"
#include "lie/tree/tree.hpp"

#include <vector>

namespace hilda::lie {

class ArticulatedBodies {
public:
    /// Both arguments must outlive the object.
    ArticulatedBodies(const Mass& mass, const Tree& tree);

    /// Sets r̈ and ω̄̇ of all bodies, and q̈ of all joints in their order: the acceleration of the angle or
    /// the displacement; for a ball the derivative of the angular velocity relative to the body before, in
    /// the frame of the body; for a free body r̈ and ω̄̇. x satisfies the joints.
    void solve(State& x, const Loads& loads, Eigen::VectorXd& qddot);

private:
    /// A joint and the bodies behind it
    struct Work {
        Vec3 omega, Q, rho;  ///< angular velocity; point of the joint; from Q to the centre of mass
        Vec3 axis;           ///< of a hinge or a slide
        Vec3 D;              ///< from the point Q of the body before
        Vec3 c_a, c_alpha;   ///< acceleration for q̈ = 0 without that of the body before
        Vec3 centripetal;    ///< ω × (ω × rho)
        Mat3 A, B, C;        ///< I of the bodies
        Vec3 p_F, p_M;       ///< p of the bodies
        Mat3 D_inverse;      ///< of a ball: D⁻¹; otherwise 1/D in its first number
        Vec3 U_F, U_M;       ///< of a hinge or a slide
        Vec3 u;              ///< -Sᵀ p
        Vec3 a, alpha;       ///< accelerations
    };

    void set_body(int k, const State& x, const Loads& loads);
    void eliminate(int k);
    void accelerate(int k, const Mat3& A, Eigen::VectorXd& qddot, int at);

    const Mass& mass;
    const Tree& tree;
    std::vector<int> joint_of;  ///< number of the joint of each body
    std::vector<Work> work;     ///< of each joint
    Work ground;
};

}  // namespace hilda::lie
