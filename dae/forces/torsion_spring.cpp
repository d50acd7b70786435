// SPDX-License-Identifier: GPL-3.0-or-later
/// Torsional spring-damper: angle, torque and potential energy.
#include "dae/forces/torsion_spring.hpp"

#include "lie/check.hpp"

namespace hilda::dae {

namespace {

constexpr double pi = 3.14159265358979323846;

}  // namespace

TorsionSpring::TorsionSpring(int i, const Vec3& axis_i, int j, const Vec3& axis_j, double stiffness,
                             double damping, double free_angle, const State& start)
    : i(i), j(j), stiffness(stiffness), damping(damping), free_angle(free_angle)
{
    for (const Vec3* axis : {&axis_i, &axis_j})
        if (!(axis->norm() > 0))
            lie::reject("torsion spring", "an axis must have a positive length", axis->norm());
    axis_bar_i = axis_i.normalized();
    u_bar_i = axis_bar_i.unitOrthogonal();
    v_bar_i = axis_bar_i.cross(u_bar_i);
    const Motion &bi = motion(start, i), &bj = motion(start, j);
    const double cosine = (bi.A * axis_bar_i).dot(bj.A * axis_j.normalized());
    if (cosine < 1 - 1e-6)
        lie::reject("torsion spring",
                    "the two axes must be parallel at the start and point in the same direction; "
                    "cosine of their angle",
                    cosine);
    u_bar_j = bj.A.transpose() * (bi.A * u_bar_i);
}

double TorsionSpring::angle(const State& x) const
{
    const Vec3 u_j = motion(x, i).A.transpose() * (motion(x, j).A * u_bar_j);
    const double within_turn = std::atan2(v_bar_i.dot(u_j), u_bar_i.dot(u_j));
    const double saved_angle = x.discrete_state[first_discrete_state] * (pi / 2);
    return within_turn + 2 * pi * std::round((saved_angle - within_turn) / (2 * pi));
}

void TorsionSpring::update_internal_state(State& x) const
{
    x.discrete_state[first_discrete_state] = static_cast<int>(std::lround(angle(x) / (pi / 2)));
}

void TorsionSpring::add(const State& x, lie::Loads& out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 axis = bi.A * axis_bar_i;
    const double thetadot = axis.dot(bj.A * bj.omega_bar - bi.A * bi.omega_bar);
    const Vec3 n = (stiffness * (angle(x) - free_angle) + damping * thetadot) * axis;
    if (i != ground) out.n_bar[i] += bi.A.transpose() * n;
    if (j != ground) out.n_bar[j] -= bj.A.transpose() * n;
}

double TorsionSpring::potential_energy(const State& x) const
{
    const double twist = angle(x) - free_angle;
    return 0.5 * stiffness * twist * twist;
}

}  // namespace hilda::dae
