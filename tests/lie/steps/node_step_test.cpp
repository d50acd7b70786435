// SPDX-License-Identifier: GPL-3.0-or-later
/// The saddle matrix of a node belongs to the whole state of the node.

#include "lie/steps/node_step.hpp"

#include "lie/settings.hpp"
#include "lie/system.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

namespace {

/// A body that cannot move along a direction, which depends on the state: x if the discrete state and α are
/// 0, y if one of them is 1, z if both are.
class GuidedBody final : public lie::System {
public:
    GuidedBody()
    {
        inertia.m = {1};
        inertia.J_bar = {lie::Mat3::Identity()};
        rows_pattern.entry.push_back({});
        rows_pattern.start.push_back(1);
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads& out) const override
    {
        out.F[0] = Vec3(1, 1, 1), out.n_bar[0].setZero();
    }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out[0] = x.body[0].r[axis(x)];
    }
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        out.entry[0].r = Vec3::Unit(axis(x));
    }
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }

    static int axis(const lie::State& x) { return x.discrete_state[0] + static_cast<int>(x.alpha[0]); }

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

class AccelerationsOnly final : public lie::NodeStep {
public:
    using NodeStep::NodeStep;
    using NodeStep::set_accelerations;
    int step(lie::State&, double) override { return 0; }
};

}  // namespace

TEST_CASE("the accelerations of a node change with its discrete states and algebraic variables alone",
          "[lie][steps]")
{
    const GuidedBody system;
    AccelerationsOnly step(system, {});
    lie::State x;
    x.body.resize(1);
    x.lambda = Eigen::VectorXd::Zero(1);
    x.discrete_state = {0};
    x.alpha = Eigen::VectorXd::Zero(1);
    const auto check = [&] {
        step.set_accelerations(x);
        INFO("discrete state " << x.discrete_state[0] << ", alpha " << x.alpha[0]);
        CHECK((x.body[0].rddot - (Vec3(1, 1, 1) - Vec3::Unit(GuidedBody::axis(x)))).norm() < 1e-14);
        CHECK(x.lambda[0] == Approx(1));
    };
    check();
    x.discrete_state[0] = 1;
    check();
    x.alpha[0] = 1;
    check();
    x.discrete_state[0] = 0;
    check();
    x.alpha[0] = 0;
    check();
}
