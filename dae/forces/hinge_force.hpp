// SPDX-License-Identifier: GPL-3.0-or-later
/// A torque about the common axis of two bodies that depends on their relative angle.
#pragma once

#include "dae/force.hpp"

#include <algorithm>
#include <utility>

namespace hilda::dae {

/// Torque n(theta, thetadot) [N m] about a common axis of two bodies i and j.
///
/// theta is the rotation of body j relative to body i about the axis since the start. It is positive for a
/// right-handed rotation and is not limited to one revolution. The torque n along the axis acts on body i,
/// and -n on body j.
///
/// After each accepted step theta is stored as the nearest number of quarter revolutions. The angle within a
/// revolution is resolved with this number. One step may therefore rotate by less than 3/8 of a revolution;
/// check_step() compares the change with the rates at both ends of the step.
class HingeForce : public Force {
public:
    int i, j;
    Vec3 axis_bar_i;        ///< unit vector, frame of body i
    Vec3 u_bar_i, v_bar_i;  ///< (u, v, axis): right-handed orthonormal, body i
    Vec3 u_bar_j;           ///< fixed in body j, equal to u_i at the start

    /// theta is zero in the state `start`. `type` is for messages. Throws lie::InvalidInput for an axis of
    /// length zero, and for axes that do not point in the same direction in `start`.
    HingeForce(const char* type, int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j,
               const State& start);

    virtual double torque(double theta, double thetadot) const = 0;
    virtual double potential(double theta) const = 0;  ///< [J]
    /// Stiffness [N m/rad] and damping [N m s/rad] of the torque, for the stability limit of the step
    virtual std::pair<double, double> coefficients() const { return {0, 0}; }

    /// ∂n/∂theta and ∂n/∂thetadot. The default computes central differences.
    virtual std::pair<double, double> torque_derivatives(double theta, double thetadot) const;

    void add(const State& x, lie::Loads& out) const override;
    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    double potential_energy(const State& x) const override { return potential(angle(x)); }

    std::vector<Quantity> quantities() const override;
    void values(const State& x, double* out) const override;

    int discrete_states() const override { return 1; }
    void update_internal_state(State& x) const override;
    void check_step(const State& before, const State& after) const override;
    int max_spring_rows() const override { return 1; }
    int spring_rows(const State& x, SpringRow* out) const override;
    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }

    /// theta [rad]: of the angles that differ by whole revolutions, the one nearest to the number stored in x
    double angle(const State& x) const;
    /// thetadot [rad/s]
    double rate(const State& x) const;

protected:
    /// Of the angles that differ by whole revolutions, the one nearest to `theta` [rad]
    double nearest_angle(const State& x, double theta) const;
    /// Stores theta in x as the nearest number of quarter revolutions.
    void store(double theta, State& x) const;
};

}  // namespace hilda::dae
