// SPDX-License-Identifier: GPL-3.0-or-later
/// The derivatives of the equations of motion against differences.

#include "lie/solver/tangent.hpp"
#include "lie/system.hpp"
#include "tests/support/driven_top.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/sprung_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using Vec6 = Eigen::Matrix<double, 6, 1>;

namespace {

/// x with its pose changed by s along component c, or its velocity for c ≥ 6
lie::State displaced(lie::State x, int c, double s)
{
    lie::Motion& body = x.body[0];
    if (c < 3)
        body.r[c] += s;
    else if (c < 6)
        body.A = body.A * lie::exp(s * lie::Vec3::Unit(c - 3));
    else
        (c < 9 ? body.rdot : body.omega_bar)[c % 3] += s;
    return x;
}

/// Cᵀ λ - Q in the state x
Vec6 residual(const lie::System& system, const lie::State& x)
{
    lie::Loads loads(1);
    lie::Rows C = system.pattern();
    system.loads(x, loads);
    system.variation(x, C);
    Vec6 e;
    e << -loads.F[0], -loads.tau_bar(0, system.mass().J_bar[0], x.body[0].omega_bar);
    C.add_transpose(1, x.lambda, e);
    return e;
}

/// C v - ν in the state x with the velocity v
Eigen::VectorXd velocity_error(const lie::System& system, const lie::State& x, const Vec6& v)
{
    lie::Rows C = system.pattern();
    Eigen::VectorXd e(system.rows());
    system.variation(x, C);
    system.nu(x, e);
    for (int k = 0; k < C.rows(); ++k) e[k] = C.dot(k, v) - e[k];
    return e;
}

template <class Top>
void compare(const Top& top)
{
    const lie::State x = top.start();
    lie::Tangent tangent(top);
    tangent.evaluate_with_velocities(x);
    REQUIRE(tangent.block.size() == 1);
    Vec6 v;
    v << x.body[0].rdot, x.body[0].omega_bar;
    for (int c = 0; c < 6; ++c) {
        const auto of_pose = [&](double s) { return residual(top, displaced(x, c, s)); };
        const auto of_velocity = [&](double s) { return residual(top, displaced(x, c + 6, s)); };
        const auto of_rows = [&](double s) { return velocity_error(top, displaced(x, c, s), v); };
        INFO("component " << c);
        const double scale = 1 + tangent.block[0].K.norm();
        CHECK((tangent.block[0].K.col(c) - tests::derivative(of_pose)).norm() < 1e-8 * scale);
        CHECK((tangent.block[0].D.col(c) - tests::derivative(of_velocity)).norm() < 1e-8 * scale);
        const Eigen::VectorXd rows = tests::derivative(of_rows);
        for (int k = 0; k < top.rows(); ++k)
            CHECK(tangent.velocity_variation(k, Eigen::VectorXd(Vec6::Unit(c))) ==
                  Approx(rows[k]).margin(1e-8));
    }
}

}  // namespace

TEST_CASE("stiffness, damping and variation of the velocities are derivatives of the equations",
          "[lie][tangent]")
{
    compare(tests::SpinningTop());
    compare(tests::DrivenTop());
    compare(tests::SprungTop(300, 20));
}

TEST_CASE("the solution of the Newton matrix is that of its dense form", "[lie][tangent]")
{
    const tests::DrivenTop top;
    lie::Tangent tangent(top);
    tangent.evaluate_with_velocities(top.start());
    using Complex = std::complex<double>;
    lie::TangentMatrix<Complex> N(tangent, lie::TangentMatrix<Complex>::Constraints::velocity);
    const Complex factor(0.02, -0.01);
    N.rotation[0] = factor * (Eigen::Matrix3cd::Identity() + 0.1 * lie::tilde(lie::Vec3(1, 2, 3)));
    N.assemble(factor, 2. * factor, factor);
    N.factor();

    Eigen::Matrix<Complex, 6, 6> P = Eigen::Matrix<Complex, 6, 6>::Zero();
    P.topLeftCorner<3, 3>() = factor * Eigen::Matrix3cd::Identity();
    P.bottomRightCorner<3, 3>() = N.rotation[0];
    Eigen::Matrix<double, 3, 6> C, V;
    for (int k = 0; k < 3; ++k) {
        C.row(k) << tangent.C.entry[k].r.transpose(), tangent.C.entry[k].pi.transpose();
        V.row(k) = tangent.V[k];
    }
    Eigen::MatrixXcd dense = Eigen::MatrixXcd::Zero(9, 9);
    dense.topLeftCorner<6, 6>() =
        factor * tangent.block[0].D.cast<Complex>() + 2. * factor * (tangent.block[0].K.cast<Complex>() * P);
    dense.topLeftCorner<3, 3>() += top.mass().m[0] * lie::Mat3::Identity();
    dense.block<3, 3>(3, 3) += top.mass().J_bar[0];
    dense.topRightCorner<6, 3>() = C.transpose().cast<Complex>();
    dense.bottomLeftCorner<3, 6>() = C.cast<Complex>() + V.cast<Complex>() * P;
    const Eigen::VectorXcd b = Eigen::VectorXcd::LinSpaced(9, Complex(1, -1), Complex(2, 3));
    Eigen::VectorXcd z = b;
    N.solve(z);
    CHECK((dense * z - b).norm() < 1e-12 * b.norm());
}
