// SPDX-License-Identifier: GPL-3.0-or-later
/// Torsional spring-damper.
#pragma once

#include "dae/forces/hinge_force.hpp"

namespace hilda::dae {

/// Torsion spring and damper about a common axis of two bodies:
///
///     n = k (theta - theta_0) + c thetadot   [N m]
class TorsionSpring final : public HingeForce {
public:
    double stiffness = 0, damping = 0, free_angle = 0;  ///< k [N m/rad], c [N m s/rad], theta_0 [rad]

    TorsionSpring(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, double stiffness,
                  double damping, double free_angle, const State& start)
        : HingeForce("torsion spring", i, axis_bar_i, j, axis_bar_j, start), stiffness(stiffness),
          damping(damping), free_angle(free_angle)
    {}

    double torque(double theta, double thetadot) const override
    {
        return stiffness * (theta - free_angle) + damping * thetadot;
    }
    double potential(double theta) const override
    {
        const double twist = theta - free_angle;
        return 0.5 * stiffness * twist * twist;
    }
    std::pair<double, double> coefficients() const override { return {stiffness, damping}; }
    std::pair<double, double> torque_derivatives(double, double) const override
    {
        return {stiffness, damping};
    }
    bool may_be_implicit() const override { return true; }
    bool is_passive() const override { return damping >= 0; }
    bool is_dissipative() const override { return damping != 0; }
};

}  // namespace hilda::dae
