// SPDX-License-Identifier: GPL-3.0-or-later
/// The poses and velocities of the bodies of a tree from the coordinates and rates of its joints.

#pragma once

#include "lie/state.hpp"
#include "lie/tree/tree.hpp"

#include <vector>

namespace hilda::lie {

/// The local coordinates u of a step: u = 0 at its origin. They are the increments of an angle [rad] or a
/// displacement [m], the rotation vector of a ball with A_j = A_i R_n exp(ũ), and r - r_n and θ of a free
/// body with A = A_n exp(θ̃). The rates w are those of an angle or displacement, the angular velocity of a
/// ball relative to the body before, in the frame of the body, and ṙ and ω̄ of a free body:
///
///     u̇ = w,  but  u̇ = J_r(u)⁻¹ w  for a rotation vector
///
/// The poses satisfy the joints up to rounding.
class JointCoordinates {
public:
    /// `tree` must outlive the object.
    explicit JointCoordinates(const Tree& tree);

    /// Number of joint coordinates of all joints
    int freedoms() const { return count; }

    /// Makes x the origin, and sets w to its rates and wdot to their derivatives by r̈ and ω̄̇ of x.
    void start(const State& x, Eigen::Ref<Eigen::VectorXd> w, Eigen::Ref<Eigen::VectorXd> wdot);
    /// Sets the poses and velocities of x.
    void place(const Eigen::Ref<const Eigen::VectorXd>& u, const Eigen::Ref<const Eigen::VectorXd>& w,
               State& x) const;
    /// u̇
    void set_rates(const Eigen::Ref<const Eigen::VectorXd>& u, const Eigen::Ref<const Eigen::VectorXd>& w,
                   Eigen::Ref<Eigen::VectorXd> udot) const;

    /// The variation of the bodies at the origin: (δr, δθ̄) of each body from the variation δu of the
    /// coordinates, written to the components 12 i + first … 12 i + first + 5 of `out`. The same map gives
    /// (ṙ, ω̄) from rates.
    void spread(const Eigen::Ref<const Eigen::VectorXd>& du, int first, Eigen::VectorXd& out) const;

private:
    /// The coordinates of a joint at the origin, and its geometry there
    struct Origin {
        Vec3 d, rho, axis;  ///< from the centre of mass before to Q, from Q to that of the body; the axis
        Mat3 A;             ///< of the body
        double cosine = 1, sine = 0, displacement = 0;  ///< of a hinge; of a slide
        Mat3 R = Mat3::Identity();                      ///< A_iᵀ A_j of a ball; A of a free body
        Vec3 r = Vec3::Zero();                          ///< of a free body
    };

    const Tree& tree;
    int count = 0;
    std::vector<Origin> origin;
};

}  // namespace hilda::lie
