// SPDX-License-Identifier: GPL-3.0-or-later
/// Checks that every reference motion in contact must pass.

#pragma once

#include "reference/motions/contact_instant.hpp"
#include "tests/support/finite_difference.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <vector>

namespace hilda::tests {

using reference::ContactInstant;
using reference::Mat3;
using reference::Vec3;

/// t - 2h, t - h, t, t + h, t + 2h
inline std::vector<double> five_instants(double t, double h)
{
    return {t - 2 * h, t - h, t, t + h, t + 2 * h};
}

/// Checks five states of a motion, h apart: velocities and accelerations are the derivatives of positions and
/// velocities, the Newton-Euler equations are satisfied under gravity g along -z, and p and ā are the same
/// point.
///
/// `rate` [1/s] is the rate of change of the motion. With h · rate near 4e-3 the finite differences have a
/// relative truncation error of 1e-11 and a smaller rounding error. Tolerances of derivatives are scaled with
/// the rate.
inline void check_motion(const std::vector<ContactInstant>& x, double h, double m, const Mat3& J_bar,
                         double g, double rate)
{
    REQUIRE(x.size() == 5);
    const auto derivative = [&](auto member) {
        return tests::derivative([&](double s) { return member(x[2 + std::lround(s / h)]); }, h);
    };
    const ContactInstant& c = x[2];
    const Vec3 rdot = derivative([](const ContactInstant& k) { return k.body.r; });
    const Vec3 rddot = derivative([](const ContactInstant& k) { return k.body.rdot; });
    const Mat3 Adot = derivative([](const ContactInstant& k) { return k.body.A; });
    const Vec3 omegadot_bar = derivative([](const ContactInstant& k) { return k.body.omega_bar; });
    INFO("t = " << c.t);
    CHECK((rdot - c.body.rdot).norm() < 1e-9 * (1 + c.body.rdot.norm()));
    CHECK((rddot - c.body.rddot).norm() < 1e-9 * rate * (1 + c.body.rdot.norm()));
    CHECK((c.body.A.transpose() * Adot - lie::tilde(c.body.omega_bar)).norm() < 1e-9 * rate);
    CHECK((omegadot_bar - c.body.omegadot_bar).norm() < 1e-9 * rate * rate);

    const Vec3 weight(0, 0, -m * g), moment = c.body.A.transpose() * c.moment;
    const double scale = weight.norm() + c.F().norm();
    CHECK((m * c.body.rddot - weight - c.F()).norm() < 1e-13 * scale);
    CHECK((J_bar * c.body.omegadot_bar + c.body.omega_bar.cross(J_bar * c.body.omega_bar) -
           c.a_bar.cross(c.body.A.transpose() * c.F()) - moment)
              .norm() < 1e-12 * scale * c.a_bar.norm());

    CHECK((c.body.r + c.body.A * c.a_bar - c.p).norm() < 1e-15 * (1 + 10 * c.p.norm()));
    CHECK(c.n.norm() == Approx(1).epsilon(1e-14));
    CHECK(std::abs(c.n.dot(c.F_t)) < 1e-13 * scale);
    CHECK(lie::orthogonality_error(c.body.A) < 1e-14);
}

}  // namespace hilda::tests
