// SPDX-License-Identifier: GPL-3.0-or-later
/// A top with loads that depend on velocities and time, on a driven joint.
#pragma once

#include "tests/support/spinning_top.hpp"

namespace hilda::tests {

/// A top with air resistance and a bearing with friction. Its point s_bar is moved along p(t).
class DrivenTop final : public lie::System {
public:
    DrivenTop()
    {
        inertia.m = {2.0};
        inertia.J_bar = {Vec3(0.05, 0.08, 0.06).asDiagonal()};
        for (int k = 0; k < 3; ++k) {
            rows_pattern.entry.push_back({});
            rows_pattern.start.push_back(k + 1);
        }
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }

    void loads(const lie::State& x, lie::Loads& out) const override
    {
        const lie::Motion& body = x.body[0];
        out.F[0] = Vec3(std::sin(3 * x.t), 0, -2.0 * 9.81) - 1.5 * (1 + body.rdot.norm()) * body.rdot;
        out.n_bar[0] = Vec3(-0.1, -0.2, -0.15).cwiseProduct(body.omega_bar);
    }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out = x.body[0].r + x.body[0].A * s_bar - Vec3(0.1 * std::sin(4 * x.t), 0.05 * x.t * x.t, 0);
    }
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        for (int k = 0; k < 3; ++k) {
            out.entry[k].r = Vec3::Unit(k);
            out.entry[k].pi = s_bar.cross(x.body[0].A.transpose() * Vec3::Unit(k));
        }
    }
    void nu(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out = Vec3(0.4 * std::cos(4 * x.t), 0.1 * x.t, 0);
    }
    void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        const Vec3& w = x.body[0].omega_bar;
        out = Vec3(-1.6 * std::sin(4 * x.t), 0.1, 0) - x.body[0].A * w.cross(w.cross(s_bar));
    }
    lie::LoadVariation load_pattern() const override
    {
        lie::LoadVariation out;
        out.block.push_back({.on = 0, .by = 0});
        return out;
    }
    void load_variation(const lie::State& x, lie::LoadVariation& out) const override
    {
        const lie::Motion& body = x.body[0];
        const double speed = body.rdot.norm();
        auto& d = out.block[0].d;
        d.setZero();
        d.block<3, 3>(0, 6) = -1.5 * ((1 + speed) * lie::Mat3::Identity() +
                                      body.rdot * body.rdot.transpose() / (speed > 0 ? speed : 1));
        d.block<3, 3>(3, 9) = lie::Mat3(Vec3(-0.1, -0.2, -0.15).asDiagonal());
    }

    lie::State start() const { return tilted_top(*this, s_bar, Vec3(0.4, 0, 0)); }

private:
    const Vec3 s_bar = Vec3(0.05, -0.1, -0.25);
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

}  // namespace hilda::tests
