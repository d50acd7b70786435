// SPDX-License-Identifier: GPL-3.0-or-later
/// The angle of a vector about an axis of a body.
#include "dae/constraints/angle.hpp"

#include "dae/block_terms.hpp"

#include <cmath>
#include <numbers>

namespace hilda::dae {

namespace {

/// The angle of v with the derivatives v̇ and v̈ (without accelerations), and its gradient g = ∂φ/∂v. With
/// x = v · u, y = v · w and ρ² = x² + y²
///
///     δφ = (x δy - y δx)/ρ² = g · δv + (g × v) · δθ_i,     g = (x w - y u)/ρ²
///     φ̈  = (x ÿ - y ẍ)/ρ² - 2 (x ẋ + y ẏ)(x ẏ - y ẋ)/ρ⁴
Angle angle_of(const AngleFrame& frame, const Motion& bi, const Vec3& v, const Vec3& vdot, const Vec3& vddot,
               double near, Vec3& g)
{
    const BodyFixedVector u(bi, frame.u_bar), w(bi, frame.w_bar);
    const double x = v.dot(u.v), y = v.dot(w.v), rho2 = x * x + y * y;
    const double xdot = vdot.dot(u.v) + v.dot(u.vdot), ydot = vdot.dot(w.v) + v.dot(w.vdot);
    const double xddot = vddot.dot(u.v) + 2 * vdot.dot(u.vdot) + v.dot(u.centripetal),
                 yddot = vddot.dot(w.v) + 2 * vdot.dot(w.vdot) + v.dot(w.centripetal);
    g = (x * w.v - y * u.v) / rho2;
    Angle a{.value = nearest_revolution(std::atan2(y, x), near), .variation = Variation::zero()};
    a.variation.pi_i = bi.A.transpose() * g.cross(v);
    a.rate = (x * ydot - y * xdot) / rho2;
    a.quadratic = (x * yddot - y * xddot) / rho2 - 2 * (x * xdot + y * ydot) / rho2 * a.rate;
    return a;
}

}  // namespace

double nearest_revolution(double angle, double near)
{
    constexpr double revolution = 2 * std::numbers::pi;
    return angle + revolution * std::round((near - angle) / revolution);
}

Angle angle_of_vector(const AngleFrame& frame, const Motion& bi, const Motion& bj, const Vec3& a_bar_j,
                      double near)
{
    const BodyFixedVector a(bj, a_bar_j);
    Vec3 g;
    Angle angle = angle_of(frame, bi, a.v, a.vdot, a.centripetal, near, g);
    angle.variation.pi_j = a_bar_j.cross(bj.A.transpose() * g);
    return angle;
}

Angle angle_of_points(const AngleFrame& frame, const Motion& bi, const Vec3& s_bar_i, const Motion& bj,
                      const Vec3& s_bar_j, double near)
{
    const BodyFixedVector s_i(bi, s_bar_i), s_j(bj, s_bar_j);
    Vec3 g;
    Angle angle = angle_of(frame, bi, bj.r + s_j.v - bi.r - s_i.v, bj.rdot + s_j.vdot - bi.rdot - s_i.vdot,
                           s_j.centripetal - s_i.centripetal, near, g);
    angle.variation.r_i = -g;
    angle.variation.pi_i -= s_bar_i.cross(bi.A.transpose() * g);
    angle.variation.r_j = g;
    angle.variation.pi_j = s_bar_j.cross(bj.A.transpose() * g);
    return angle;
}

}  // namespace hilda::dae
