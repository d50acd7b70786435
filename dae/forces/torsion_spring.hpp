// SPDX-License-Identifier: GPL-3.0-or-later
/// Torsional spring-damper.
#pragma once

#include "dae/force.hpp"

namespace hilda::dae {

/// Torsion spring and damper about a common axis of two bodies i and j:
///
///     n = k (theta - theta_0) + c thetadot   [N m]
///
/// theta is the rotation of body j relative to body i about the axis since the start. It is positive for a
/// right-handed rotation and is not limited to one revolution. The torque n along the axis acts on body i,
/// and -n on body j.
///
/// After each accepted step theta is stored as the nearest number of quarter revolutions. The angle within a
/// revolution is resolved with this number. One step may therefore rotate by less than 3/8 of a revolution.
class TorsionSpring final : public Force {
public:
    int i, j;
    Vec3 axis_bar_i;                                    ///< unit vector, frame of body i
    Vec3 u_bar_i, v_bar_i;                              ///< (u, v, axis): right-handed orthonormal, body i
    Vec3 u_bar_j;                                       ///< fixed in body j, equal to u_i at the start
    double stiffness = 0, damping = 0, free_angle = 0;  ///< k [N m/rad], c [N m s/rad], theta_0 [rad]

    /// theta is zero in the state `start`. Throws lie::InvalidInput for an axis of length zero, and for axes
    /// that do not point in the same direction in `start`.
    TorsionSpring(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, double stiffness,
                  double damping, double free_angle, const State& start);

    void add(const State& x, lie::Loads& out) const override;
    double potential_energy(const State& x) const override;

    int discrete_states() const override { return 1; }
    void update_internal_state(State& x) const override;
    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }

    /// theta [rad]: of the angles that differ by whole revolutions, the one nearest to the number stored in x
    double angle(const State& x) const;
};

}  // namespace hilda::dae
