// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dae/force.hpp"

namespace hilda::dae {

/// Torsion spring and damper about a common axis of two bodies:
///
///     n = k (theta - theta_0) + c thetadot   [N m]
///
/// theta is the angle through which body j has turned about the axis relative to body i since the start,
/// right-handed and counted through whole turns; n acts on body i along the axis, -n on body j. The turns are
/// counted once per accepted step, to the nearest quarter, so a step may turn by less than three eighths of a
/// turn.
class TorsionSpring final : public Force {
public:
    int i, j;
    Vec3 axis_bar_i;                                    ///< unit, body i
    Vec3 u_bar_i, v_bar_i;                              ///< unit, perpendicular to the axis, right-handed
    Vec3 u_bar_j;                                       ///< what u_i pointed along at the start, body j
    double stiffness = 0, damping = 0, free_angle = 0;  ///< k [N m/rad], c [N m s/rad], theta_0 [rad]

    /// `start` gives the pose from which angles count. Throws lie::InvalidInput for an axis of length zero,
    /// or axes that are not parallel there.
    TorsionSpring(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, double stiffness,
                  double damping, double free_angle, const State& start);

    void add(const State& x, lie::Loads& out) const override;
    double potential_energy(const State& x) const override;

    int discrete_states() const override { return 1; }
    void update_internal_state(State& x) const override;
    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }

    /// theta [rad], nearest to the quarter turns remembered in x
    double angle(const State& x) const;
};

}  // namespace hilda::dae
