// SPDX-License-Identifier: GPL-3.0-or-later
/// A body that slides on a plane with regularised friction rows: a minimal lie::System with such rows.
#pragma once

#include "lie/system.hpp"

namespace hilda::tests {

/// The centre of mass of the body is on the plane z = 0, and the body rotates about z only: rows 0 to 2. Rows
/// 3 and 4 are friction along x and y, a dashpot with the Coulomb bound μ N. N is the weight.
class SlidingBody final : public lie::System {
public:
    static constexpr double m = 2, g = 9.81, mu = 0.3;

    SlidingBody()
    {
        inertia.m = {m};
        inertia.J_bar = {lie::Vec3(0.05, 0.08, 0.06).asDiagonal()};
        for (int k = 0; k < 5; ++k) {
            rows_pattern.entry.push_back({});
            rows_pattern.start.push_back(k + 1);
        }
        rows_pattern.velocity_rows = 2;
        rows_pattern.regularised = rows_pattern.unilateral = {3, 4};
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }

    void loads(const lie::State&, lie::Loads& out) const override
    {
        out.F[0] = {0, 0, -m * g};
        out.n_bar[0].setZero();
    }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        const lie::Motion& body = x.body[0];
        out << body.A(0, 2), body.A(1, 2), -body.r.z(), 0, 0;
    }
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        for (int k = 0; k < 2; ++k) {
            out.entry[k].pi = lie::Vec3::UnitZ().cross(x.body[0].A.row(k).transpose());
            out.entry[3 + k].r = lie::Vec3::Unit(k);
        }
        out.entry[2].r = -lie::Vec3::UnitZ();
    }
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        const lie::Vec3& w = x.body[0].omega_bar;
        const lie::Vec3 centripetal = x.body[0].A * w.cross(w.cross(lie::Vec3::UnitZ()));
        out << -centripetal.head<2>(), 0, 0, 0;
    }
    std::vector<lie::BoundedPair> bounded_pairs() const override
    {
        lie::BoundedPair pair;
        pair.first = 3, pair.normal_row = 0;
        pair.K = 1e-6, pair.D = 1e4, pair.mu = mu, pair.n = lie::Vec3::UnitZ();
        return {pair};
    }
    void update_pairs(const lie::State&, std::vector<lie::BoundedPair>& pair) const override
    {
        pair = bounded_pairs();
    }

    /// Sliding with the velocity v along the plane, and rotating about z
    static lie::State start(const lie::Vec3& v)
    {
        lie::State x;
        x.body.resize(1);
        x.body[0].rdot = v;
        x.body[0].omega_bar = {0, 0, 4};
        x.lambda = Eigen::VectorXd::Zero(5);
        return x;
    }

private:
    lie::Mass inertia;
    lie::Rows rows_pattern;
};

}  // namespace hilda::tests
