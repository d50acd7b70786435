// SPDX-License-Identifier: GPL-3.0-or-later
/// Poses and velocities between the ends of a step.

#pragma once

#include "lie/state.hpp"

#include <cstddef>

namespace hilda::lie {

/// The cubic polynomial from 0 to `end`, with the slopes v and w at 0 and 1, at s, and its slope
struct Hermite {
    Vec3 value, slope;
    Hermite(const Vec3& end, const Vec3& v, const Vec3& w, double s)
    {
        const Vec3 c3 = v + w - 2 * end, c2 = 3 * end - 2 * v - w;
        value = s * (v + s * (c2 + s * c3));
        slope = v + s * (2 * c2 + 3 * s * c3);
    }
};

/// Pose and velocity of a body at the fraction s of a step h from a to b, on the cubic Hermite polynomials of
/// r and of θ = log(A_aᵀ A)
inline Motion between(const Motion& a, const Motion& b, double h, double s)
{
    const Vec3 turn = log(a.A.transpose() * b.A), turn_rate = right_jacobian_inverse(turn) * b.omega_bar;
    const Hermite r(b.r - a.r, h * a.rdot, h * b.rdot, s), theta(turn, h * a.omega_bar, h * turn_rate, s);
    Motion x = b;
    x.r = a.r + r.value, x.rdot = r.slope / h;
    x.A = a.A * exp(theta.value);
    x.omega_bar = right_jacobian(theta.value) * theta.slope / h;
    return x;
}

/// Sets the time, the poses and the velocities of x to those at the fraction s from `from` to `to`, on the
/// paths of between(). They need not satisfy the constraints.
inline void set_between(const State& from, const State& to, double s, State& x)
{
    const double h = to.t - from.t;
    for (std::size_t i = 0; i < x.body.size(); ++i) {
        const Motion at = between(from.body[i], to.body[i], h, s);
        x.body[i].r = at.r, x.body[i].rdot = at.rdot;
        x.body[i].A = at.A, x.body[i].omega_bar = at.omega_bar;
    }
    x.t = from.t + s * h;
}

}  // namespace hilda::lie
