// SPDX-License-Identifier: GPL-3.0-or-later
/// A top on a ball joint: a minimal lie::System without joints, names or files.
#pragma once

#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/system.hpp"
#include "lie/tree/tree.hpp"

namespace hilda::tests {

using lie::Mat3;
using lie::Vec3;

/// State of a tilted, spinning and precessing top, consistent in position, velocity and acceleration. Its
/// point s_bar [m, body frame] is at the origin with the velocity v [m/s].
inline lie::State tilted_top(const lie::System& top, const Vec3& s_bar, const Vec3& v = Vec3::Zero())
{
    lie::State x;
    x.body.resize(1);
    lie::Motion& body = x.body[0];
    body.A = lie::exp(Vec3(0.7, -0.4, 0.2));
    body.omega_bar = Vec3(1.0, -2.0, 6.0);
    body.r = -body.A * s_bar;
    body.rdot = v - body.A * body.omega_bar.cross(s_bar);
    lie::Saddle K(top);
    lie::solve_accelerations(top, K, x);
    return x;
}

/// The point s_bar of the body is fixed at the origin. With free = true the body is torque-free instead.
class SpinningTop final : public lie::System {
public:
    explicit SpinningTop(bool free = false) : free(free)
    {
        lie::TreeJoint joint;
        joint.kind = free ? lie::TreeJoint::Kind::free : lie::TreeJoint::Kind::ball;
        if (!free) joint.s_bar_j = s_bar;
        joints.joint.push_back(joint);
        inertia.m = {2.0};
        inertia.J_bar = {Vec3(0.05, 0.08, 0.06).asDiagonal()};
        if (free) return;
        for (int k = 0; k < 3; ++k) {
            rows_pattern.entry.push_back({});
            rows_pattern.start.push_back(k + 1);
        }
    }

    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    const lie::Tree& tree() const override { return joints; }

    void loads(const lie::State&, lie::Loads& out) const override
    {
        out.F[0] = free ? Vec3(0, 0, 0) : Vec3(0, 0, -2.0 * 9.81);
        out.n_bar[0].setZero();
    }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        if (!free) out = x.body[0].r + x.body[0].A * s_bar;
    }
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        for (int k = 0; k < (free ? 0 : 3); ++k) {
            out.entry[k].r = Vec3::Unit(k);
            out.entry[k].pi = s_bar.cross(x.body[0].A.transpose() * Vec3::Unit(k));
        }
    }
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        const Vec3& omega_bar = x.body[0].omega_bar;
        if (!free) out = -x.body[0].A * omega_bar.cross(omega_bar.cross(s_bar));
    }
    void second_variation(const lie::State& x, lie::SecondVariation& out) const override
    {
        for (int k = 0; k < (free ? 0 : 3); ++k)
            out.at(k, 0, 0).bottomRightCorner<3, 3>() =
                lie::tilde(s_bar) * lie::tilde(x.body[0].A.transpose() * Vec3::Unit(k));
    }
    void nu_variation(const lie::State&, lie::Rows&) const override {}
    double potential_energy(const lie::State& x) const override
    {
        return free ? 0 : 2.0 * 9.81 * x.body[0].r.z();
    }

    /// See tilted_top()
    lie::State start() const { return tilted_top(*this, free ? Vec3(0, 0, 0) : s_bar); }

    const bool free;
    const Vec3 s_bar = Vec3(0.05, -0.1, -0.25);

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
    lie::Tree joints;
};

}  // namespace hilda::tests
