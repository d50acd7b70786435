// SPDX-License-Identifier: GPL-3.0-or-later
/// Compliant limits of a distance and of an angle.
#pragma once

#include "dae/forces/hinge_force.hpp"

#include <limits>

namespace hilda::dae {

/// One-sided stop on both sides of a range. Beyond the range, by delta > 0, it pushes back with
///
///     f = k delta max(0, 1 + d deltadot)                                 Hunt and Crossley (1975)
///
/// The force is continuous and never pulls. For small d the coefficient of restitution at the approach speed
/// v is about 1 - 2 d v/3.
struct Stop {
    double minimum = -std::numeric_limits<double>::infinity();  ///< of the range
    double maximum = std::numeric_limits<double>::infinity();
    double stiffness = 0, damping = 0;  ///< k [N/m] or [N m/rad], d [s/m] or [s/rad]

    /// Force that reduces q: positive above the maximum, negative below the minimum
    double force(double q, double qdot) const
    {
        if (q > maximum) return stiffness * (q - maximum) * std::max(0., 1 + damping * qdot);
        if (q < minimum) return stiffness * (q - minimum) * std::max(0., 1 - damping * qdot);
        return 0;
    }
    /// ∂force/∂q and ∂force/∂qdot
    std::pair<double, double> derivatives(double q, double qdot) const
    {
        if (is_within(q)) return {0, 0};
        const double sign = q > maximum ? 1 : -1, factor = 1 + sign * damping * qdot;
        if (!(factor > 0)) return {0, 0};
        return {stiffness * factor, stiffness * (q - (q > maximum ? maximum : minimum)) * sign * damping};
    }
    /// The functions whose zeros are the kinks of the force: the distances to both ends of the range,
    /// infinite without a limit, and the factor of the damping beyond it
    static constexpr int switches = 3;
    void switching(double q, double qdot, double* out) const
    {
        out[0] = q - minimum, out[1] = maximum - q;
        out[2] = is_within(q) ? 1 : 1 + (q > maximum ? damping : -damping) * qdot;
    }
    bool is_within(double q) const { return !(q > maximum) && !(q < minimum); }
    double potential(double q) const
    {
        const double delta = std::max({0., q - maximum, minimum - q});
        return 0.5 * stiffness * delta * delta;
    }
};

/// Limits of the distance of point P of body i and point Q of body j [m]
class DistanceLimit final : public Force {
public:
    DistanceLimit(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, const Stop& stop)
        : i(i), j(j), s_bar_i(s_bar_i), s_bar_j(s_bar_j), stop(stop)
    {}

    void add(const State& x, lie::Loads& out) const override;
    double potential_energy(const State& x) const override;
    bool is_passive() const override { return true; }
    bool is_dissipative() const override { return stop.damping != 0; }
    int max_spring_rows() const override { return 1; }
    int spring_rows(const State& x, SpringRow* out) const override;
    int switches() const override { return Stop::switches; }
    void switching(const State& x, double* out) const override;
    /// Infinite within the limits
    double stable_step(const State& x, LoadEvaluation evaluation = LoadEvaluation::at_step) const override;
    bool load_derivatives(const State& x, LoadDerivatives& out) const override;
    std::vector<Quantity> quantities() const override;
    void values(const State& x, double* out) const override;
    std::array<int, 2> bodies() const override { return {i, j}; }
    std::optional<PointPair> points() const override { return PointPair{i, j, s_bar_i, s_bar_j}; }
    int last_body() const override { return std::max(i, j); }

private:
    Vec3 d_ij(const State& x) const;
    Vec3 d_ijdot(const State& x) const;

    const int i, j;
    const Vec3 s_bar_i, s_bar_j;
    const Stop stop;
};

/// Limits of the rotation of body j relative to body i about a common axis since the start [rad]
class AngleLimit final : public HingeForce {
public:
    AngleLimit(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const Stop& stop,
               const State& start)
        : HingeForce("angle limit", i, axis_bar_i, j, axis_bar_j, start), stop(stop)
    {}

    double torque(double theta, double thetadot) const override { return stop.force(theta, thetadot); }
    double potential(double theta) const override { return stop.potential(theta); }
    bool is_passive() const override { return true; }
    bool is_dissipative() const override { return stop.damping != 0; }
    std::pair<double, double> coefficients() const override { return {stop.stiffness, 0}; }
    std::pair<double, double> torque_derivatives(double theta, double thetadot) const override
    {
        return stop.derivatives(theta, thetadot);
    }
    int switches() const override { return Stop::switches; }
    void switching(const State& x, double* out) const override { stop.switching(angle(x), rate(x), out); }
    /// Infinite within the limits
    double stable_step(const State& x, LoadEvaluation evaluation = LoadEvaluation::at_step) const override;

private:
    const Stop stop;
};

}  // namespace hilda::dae
