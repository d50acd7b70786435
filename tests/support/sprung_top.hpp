// SPDX-License-Identifier: GPL-3.0-or-later
/// A top on a stiff spring and damper in the place of a ball joint.
#pragma once

#include "tests/support/spinning_top.hpp"

namespace hilda::tests {

/// The force -k u - c u̇ acts on the point s_bar of the body, whose distance from the origin is u. For a
/// large k the motion is near that of SpinningTop, with the deflection F/k.
class SprungTop final : public lie::System {
public:
    SprungTop(double stiffness, double damping) : k(stiffness), c(damping) {}

    const lie::Mass& mass() const override { return free.mass(); }
    const lie::Rows& pattern() const override { return free.pattern(); }
    void loads(const lie::State& x, lie::Loads& out) const override
    {
        const lie::Motion& body = x.body[0];
        const Vec3 u = body.r + body.A * s_bar, udot = body.rdot + body.A * body.omega_bar.cross(s_bar);
        const Vec3 F = -k * u - c * udot;
        out.F[0] = F - Vec3(0, 0, 2.0 * 9.81);
        out.n_bar[0] = s_bar.cross(body.A.transpose() * F);
    }
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const lie::State&, lie::Rows&) const override {}
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void second_variation(const lie::State&, lie::SecondVariation&) const override {}
    void nu_variation(const lie::State&, lie::Rows&) const override {}
    lie::LoadVariation load_pattern() const override
    {
        lie::LoadVariation out;
        out.block.push_back({.on = 0, .by = 0});
        return out;
    }
    void load_variation(const lie::State& x, lie::LoadVariation& out) const override
    {
        const lie::Motion& body = x.body[0];
        const Mat3 S = lie::tilde(s_bar), At = body.A.transpose();
        const Vec3 w = body.omega_bar,
                   F = -k * (body.r + body.A * s_bar) - c * (body.rdot + body.A * w.cross(s_bar));
        Eigen::Matrix<double, 3, 12> dF;
        dF << -k * Mat3::Identity(), k * body.A * S + c * body.A * lie::tilde(w.cross(s_bar)),
            -c * Mat3::Identity(), c * body.A * S;
        auto& d = out.block[0].d;
        d.topRows<3>() = dF;
        d.bottomRows<3>() = S * At * dF;
        d.block<3, 3>(3, 3) += S * lie::tilde(At * F);
    }

    /// The start of SpinningTop, with the deflection for the force of its joint, and its velocities
    lie::State start() const
    {
        const SpinningTop top;
        lie::State x = top.start();
        x.body[0].r += x.lambda / k;
        x.lambda.resize(0);
        lie::Saddle K(*this);
        lie::solve_accelerations(*this, K, x);
        return x;
    }

private:
    const SpinningTop free{true};
    const Vec3 s_bar = free.s_bar;
    const double k, c;
};

}  // namespace hilda::tests
