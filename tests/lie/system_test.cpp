// SPDX-License-Identifier: GPL-3.0-or-later
/// What a system without overrides has: derivatives by central differences, and the largest position error.

#include "lie/system.hpp"

#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

#include <limits>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// A body with a nonholonomic row whose velocity depends on its pose: ν = x² + (A e_x)_z
class BodyOnBelt final : public lie::System {
public:
    BodyOnBelt()
    {
        inertia.m = {1};
        inertia.J_bar = {Mat3::Identity()};
        rows_pattern.entry.push_back({.body = 0, .r = Vec3::UnitX()});
        rows_pattern.start.push_back(1);
        rows_pattern.velocity_rows = 1;
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads&) const override {}
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void variation(const lie::State&, lie::Rows& out) const override { out = rows_pattern; }
    void nu(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out[0] = x.body[0].r.x() * x.body[0].r.x() + x.body[0].A(2, 0);
    }
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

}  // namespace

TEST_CASE("the variation of the rows by differences is the closed form", "[lie][system]")
{
    const tests::SpinningTop top;
    const lie::State x = top.start();
    lie::SecondVariation differences(top.pattern()), exact(top.pattern());
    for (lie::Mat6& block : exact.block) block.setZero();
    top.System::second_variation(x, differences);
    top.second_variation(x, exact);
    REQUIRE(differences.block.size() == 3);
    for (size_t k = 0; k < 3; ++k) {
        CHECK(exact.block[k].norm() > 0.1);
        CHECK((differences.block[k] - exact.block[k]).norm() < 1e-9);
    }
}

TEST_CASE("the variation of gamma by differences is the closed form", "[lie][system]")
{
    const tests::SpinningTop top;
    const lie::State x = top.start();
    const Mat3& A = x.body[0].A;
    const Vec3 &w = x.body[0].omega_bar, s = top.s_bar;
    // γ = -A (ω̄ × (ω̄ × s̄))
    const Mat3 by_theta = A * lie::tilde(w.cross(w.cross(s))),
               by_omega = A * (lie::tilde(w.cross(s)) + lie::tilde(w) * lie::tilde(s));
    lie::GammaVariation found(top.pattern());
    top.gamma_variation(x, found);
    REQUIRE(found.entry.size() == 3);
    for (int k = 0; k < 3; ++k) {
        const lie::GammaVariation::Entry& e = found.entry[static_cast<size_t>(k)];
        CHECK((e.theta - by_theta.row(k).transpose()).norm() < 1e-8 * by_theta.norm());
        CHECK((e.omega - by_omega.row(k).transpose()).norm() < 1e-8 * by_omega.norm());
        CHECK(e.r.norm() + e.rdot.norm() < 1e-12);
    }
}

TEST_CASE("the variation of a prescribed velocity by differences is the closed form", "[lie][system]")
{
    const BodyOnBelt system;
    lie::State x;
    x.body.resize(1);
    x.body[0].r = {0.3, -0.2, 5};
    x.body[0].A = lie::exp(Vec3(0.7, -0.4, 0.2));
    lie::Rows found = system.pattern();
    system.nu_variation(x, found);
    const Vec3 by_theta = -(x.body[0].A * lie::tilde(Vec3::UnitX())).row(2).transpose();
    CHECK((found.entry[0].r - Vec3(2 * 0.3, 0, 0)).norm() < 1e-9);
    CHECK((found.entry[0].pi - by_theta).norm() < 1e-9);
    CHECK(by_theta.norm() > 0.5);
}

TEST_CASE("the largest position error names its row, and NaN is larger than any number", "[lie][system]")
{
    const tests::SpinningTop top;
    lie::State x = top.start();
    CHECK(top.position_error(x).value < 1e-15);
    x.body[0].r += Vec3(1e-3, -7e-3, 2e-3);
    CHECK(top.position_error(x).row == 1);
    CHECK(top.position_error(x).value == Approx(7e-3).epsilon(1e-12));
    x.body[0].r.x() = std::numeric_limits<double>::quiet_NaN();
    CHECK(std::isnan(top.position_error(x).value));
    CHECK(top.position_error(x).row == 0);
    CHECK(tests::SpinningTop(true).position_error(x).row == -1);
}
