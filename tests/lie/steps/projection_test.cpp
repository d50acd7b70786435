// SPDX-License-Identifier: GPL-3.0-or-later
/// Projections and accelerations of a lie::System that is no dae::Model.

#include "lie/steps/projection.hpp"
#include "lie/check.hpp"
#include "lie/steps/accelerations.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

TEST_CASE("positions and velocities are projected onto the constraints of a system", "[lie][projection]")
{
    const tests::SpinningTop top;
    lie::Saddle K(top);
    lie::State x = top.start();
    x.body[0].r += Vec3(0.02, -0.05, 0.01);
    x.body[0].A = x.body[0].A * lie::exp(Vec3(0.1, 0.2, -0.3));
    CHECK(lie::project_positions(top, K, x) > 1);
    CHECK(top.position_error(x).value < 1e-15);
    CHECK(lie::orthogonality_error(x.body[0].A) < 1e-15);

    const lie::Motion before = x.body[0];
    lie::project_velocities(top, K, x);
    Eigen::VectorXd change(K.size()), v(K.size());
    change.head<3>() = x.body[0].rdot - before.rdot;
    change.segment<3>(3) = x.body[0].omega_bar - before.omega_bar;
    v.head<3>() = x.body[0].rdot;
    v.segment<3>(3) = x.body[0].omega_bar;
    for (int k = 0; k < 3; ++k) CHECK(std::abs(K.rows().dot(k, v)) < 1e-13);
    // The change is orthogonal to all admissible velocities in the metric of the mass.
    const double product = top.mass().m[0] * change.head<3>().dot(v.head<3>()) +
                           change.segment<3>(3).dot(top.mass().J_bar[0] * v.segment<3>(3));
    CHECK(std::abs(product) < 1e-13);
}

TEST_CASE("a position that is not finite is rejected by the projection", "[lie][projection]")
{
    const tests::SpinningTop top;
    lie::Saddle K(top);
    lie::State x = top.start();
    x.body[0].r.y() = std::nan("");
    CHECK(top.position_error(x).row == 1);
    CHECK_THROWS_AS(lie::project_positions(top, K, x), lie::NonFinite);
}

TEST_CASE("accelerations at a start and in a step are the same", "[lie][accelerations]")
{
    const tests::SpinningTop top;
    lie::Saddle K(top);
    lie::State x = top.start(), y = x;
    lie::solve_accelerations(top, K, x);
    lie::Loads loads(1);
    Eigen::VectorXd b(K.size());
    lie::solve_accelerations(top, K, y, loads, b);
    CHECK((x.body[0].rddot - y.body[0].rddot).norm() < 1e-12);
    CHECK((x.body[0].omegadot_bar - y.body[0].omegadot_bar).norm() < 1e-11);
    CHECK((x.lambda - y.lambda).norm() < 1e-11);
}
