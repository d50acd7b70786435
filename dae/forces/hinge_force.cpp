// SPDX-License-Identifier: GPL-3.0-or-later
/// A torque about the common axis of two bodies.
#include "dae/forces/hinge_force.hpp"

#include "dae/constraints/angle.hpp"
#include "dae/forces/row_load.hpp"
#include "lie/check.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

namespace hilda::dae {

using std::numbers::pi;

HingeForce::HingeForce(const char* type, int i, const Vec3& axis_i, int j, const Vec3& axis_j,
                       const State& start)
    : i(i), j(j)
{
    for (const Vec3* axis : {&axis_i, &axis_j})
        if (!(axis->norm() > 0)) lie::reject(type, "an axis must have a positive length", axis->norm());
    axis_bar_i = axis_i.normalized();
    u_bar_i = axis_bar_i.unitOrthogonal();
    v_bar_i = axis_bar_i.cross(u_bar_i);
    const Motion &bi = motion(start, i), &bj = motion(start, j);
    const double cosine = (bi.A * axis_bar_i).dot(bj.A * axis_j.normalized());
    if (!(cosine >= 1 - 1e-6))
        lie::reject(type,
                    "the two axes must be parallel at the start and point in the same direction; "
                    "cosine of their angle",
                    cosine);
    u_bar_j = bj.A.transpose() * (bi.A * u_bar_i);
}

double HingeForce::angle(const State& x) const
{
    return nearest_angle(x, x.discrete_state[first_discrete_state] * (pi / 2));
}

double HingeForce::nearest_angle(const State& x, double theta) const
{
    const Vec3 u_j = motion(x, i).A.transpose() * (motion(x, j).A * u_bar_j);
    return nearest_revolution(std::atan2(v_bar_i.dot(u_j), u_bar_i.dot(u_j)), theta);
}

void HingeForce::store(double theta, State& x) const
{
    x.discrete_state[first_discrete_state] = static_cast<int>(std::lround(theta / (pi / 2)));
}

double HingeForce::rate(const State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 axis = bi.A * axis_bar_i;
    return axis.dot(bj.A * bj.omega_bar - bi.A * bi.omega_bar);
}

std::vector<Quantity> HingeForce::quantities() const
{
    return {{"angle", "rad", "rotation of body j relative to body i about the axis since the start"},
            {"rate", "rad/s", "rate of the angle"},
            {"torque", "N m", "torque on body i along the axis; the opposite torque acts on body j"}};
}

void HingeForce::values(const State& x, double* out) const
{
    out[0] = angle(x), out[1] = rate(x), out[2] = torque(out[0], out[1]);
}

void HingeForce::update_internal_state(State& x) const { store(angle(x), x); }

void HingeForce::check_step(const State& before, const State& after) const
{
    const double expected = (after.t - before.t) / 2 * (rate(before) + rate(after));
    if (std::abs(angle(after) - angle(before) - expected) <= pi) return;
    std::ostringstream what;
    what.precision(3);
    what << label() << ": its bodies rotate by " << std::abs(expected)
         << " rad relative to each other in one step, and the limit is " << 0.75 * pi << "; reduce the step";
    throw lie::NumericalFailure("step_too_large", what.str());
}

int HingeForce::spring_rows(const State& x, SpringRow* out) const
{
    const auto [stiffness, damping] = coefficients();
    const Vec3 axis = motion(x, i).A * axis_bar_i, omega_i = motion(x, i).A * motion(x, i).omega_bar;
    out[0] = {.r_i = Vec3::Zero(),
              .pi_i = -axis_bar_i,
              .r_j = Vec3::Zero(),
              .pi_j = motion(x, j).A.transpose() * axis,
              .stiffness = stiffness,
              .damping = damping,
              .gamma = omega_i.cross(axis).dot(motion(x, j).A * motion(x, j).omega_bar)};
    return 1;
}

std::pair<double, double> HingeForce::torque_derivatives(double theta, double thetadot) const
{
    const double step = 1e-6, step_rate = 1e-6 * std::max(1., std::abs(thetadot));
    return {(torque(theta + step, thetadot) - torque(theta - step, thetadot)) / (2 * step),
            (torque(theta, thetadot + step_rate) - torque(theta, thetadot - step_rate)) / (2 * step_rate)};
}

bool HingeForce::load_derivatives(const State& x, LoadDerivatives& out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Mat3 A_ij = bi.A.transpose() * bj.A;
    const double theta = angle(x), thetadot = rate(x);
    const auto [by_theta, by_thetadot] = torque_derivatives(theta, thetadot);
    RowLoad row;
    const Vec3 axis_j = A_ij.transpose() * axis_bar_i;
    row.w << Vec3::Zero(), -axis_bar_i, Vec3::Zero(), axis_j;
    // theta = atan2(v · u_j, u · u_j) with u_j in the frame of body i
    const Vec3 u_j = A_ij * u_bar_j;
    const double cosine = u_bar_i.dot(u_j), sine = v_bar_i.dot(u_j);
    const Vec3 by_u_j = (cosine * v_bar_i - sine * u_bar_i) / (cosine * cosine + sine * sine);
    row.g << Vec3::Zero(), by_u_j.cross(u_j), Vec3::Zero(), u_bar_j.cross(A_ij.transpose() * by_u_j);
    row.W.block<3, 3>(9, 3) = -A_ij.transpose() * lie::tilde(axis_bar_i);
    row.W.block<3, 3>(9, 9) = lie::tilde(axis_j);
    out.setZero();
    row.add_to(torque(theta, thetadot), by_theta, by_thetadot, velocities(bi, bj), out);
    return true;
}

void HingeForce::add(const State& x, lie::Loads& out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 n = torque(angle(x), rate(x)) * (bi.A * axis_bar_i);
    if (i != ground) out.n_bar[i] += bi.A.transpose() * n;
    if (j != ground) out.n_bar[j] -= bj.A.transpose() * n;
}

}  // namespace hilda::dae
