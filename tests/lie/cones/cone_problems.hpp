// SPDX-License-Identifier: GPL-3.0-or-later
/// Cone problems of stacks, columns and chains, and a check of their solutions that does not use the solver.
#pragma once

#include "lie/cones/cone_problem.hpp"
#include "tests/support/random_motion.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <random>

namespace hilda::tests {

using lie::ConeRows;
using lie::Mat3;
using lie::Vec3;

/// Bodies whose frames are parallel to the global one, with contact points and ball joints
struct BodiesInContact {
    lie::Mass mass;
    lie::Rows rows;
    std::vector<ConeRows::Cone> cones;
    std::vector<double> mu;
    Eigen::VectorXd v;  ///< without contacts and joints

    int add_box(double m, const Vec3& half)
    {
        const Vec3 squared = half.cwiseAbs2();
        mass.m.push_back(m);
        mass.J_bar.push_back(
            Vec3(squared[1] + squared[2], squared[0] + squared[2], squared[0] + squared[1]).asDiagonal() *
            (m / 3));
        return static_cast<int>(mass.m.size()) - 1;
    }
    static ConeRows::Mat36 rows_at(const Mat3& axes, const Vec3& s)
    {
        ConeRows::Mat36 C;
        C << axes.transpose(), -axes.transpose() * lie::tilde(s);
        return C;
    }
    /// A contact point at s_i, s_j from the centres of mass, with the normal n into i; j = -1 is the ground.
    void add_contact(int i, int j, const Vec3& s_i, const Vec3& s_j, double of_mu,
                     const Vec3& n = Vec3::UnitZ())
    {
        ConeRows::Cone cone;
        cone.key = cones.size();
        cone.i = i, cone.j = j;
        const Vec3 across = std::abs(n.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitZ(),
                   t = (across - across.dot(n) * n).normalized();
        cone.axes << n, t, n.cross(t);
        cone.C_i = rows_at(cone.axes, s_i);
        if (j >= 0) cone.C_j = -rows_at(cone.axes, s_j);
        cone.mu_s = cone.mu_k = of_mu;
        cones.push_back(cone);
        mu.push_back(of_mu);
    }
    void add_ball(int i, int j, const Vec3& s_i, const Vec3& s_j)
    {
        for (int k = 0; k < 3; ++k) {
            const Vec3 e = Vec3::Unit(k);
            rows.entry.push_back({.body = i, .r = e, .pi = s_i.cross(e)});
            if (j >= 0) rows.entry.push_back({.body = j, .r = -e, .pi = -s_j.cross(e)});
            rows.start.push_back(static_cast<int>(rows.entry.size()));
        }
    }
    /// Velocities after a step of 1 ms under gravity from random ones with the standard deviation `speed`
    void set_velocities(double speed, unsigned seed)
    {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        v.resize(6 * static_cast<Eigen::Index>(mass.m.size()));
        for (Eigen::Index k = 0; k < v.size(); ++k)
            v[k] = speed * normal(random) - (k % 6 == 2 ? 9.81e-3 : 0);
    }
    lie::ConeProblem problem() const
    {
        lie::ConeProblem p(mass, rows);
        p.cones = &cones;
        p.mu = mu;
        p.beta.assign(mu.size(), 0);
        for (int b = 0; b < p.bodies(); ++b) p.q.segment<6>(6 * b) = p.times_mass(b, v.segment<6>(6 * b));
        return p;
    }
};

/// `n` boxes of 1 kg on each other, the top one of the mass `top`
inline BodiesInContact stack(int n, double top = 1, double speed = 0, unsigned seed = 1)
{
    BodiesInContact of;
    for (int k = 0; k < n; ++k) of.add_box(k == n - 1 ? top : 1, {0.1, 0.1, 0.1});
    for (int k = 0; k < n; ++k)
        for (const double a : {-0.1, 0.1})
            for (const double b : {-0.1, 0.1}) of.add_contact(k, k - 1, {a, b, -0.1}, {a, b, 0.1}, 0.5);
    of.set_velocities(speed, seed);
    return of;
}

inline BodiesInContact column_of_spheres(int n)
{
    BodiesInContact of;
    for (int k = 0; k < n; ++k) {
        of.add_box(1, {0.1, 0.1, 0.1});
        of.mass.J_bar.back() = 0.4 * 0.01 * Mat3::Identity();
        of.add_contact(k, k - 1, {0, 0, -0.1}, {0, 0, 0.1}, 0.3);
    }
    of.set_velocities(0, 2);
    return of;
}

/// Boxes on the ground, joined at their ends by ball joints; the last one has the mass `end`
inline BodiesInContact chain(int n, double end, double speed)
{
    BodiesInContact of;
    for (int k = 0; k < n; ++k) of.add_box(k == n - 1 ? end : 1, {0.1, 0.03, 0.03});
    for (int k = 0; k < n; ++k) {
        if (k > 0) of.add_ball(k, k - 1, {-0.1, 0, 0}, {0.1, 0, 0});
        for (const double a : {-0.1, 0.1})
            for (const double b : {-0.03, 0.03}) of.add_contact(k, -1, {a, b, -0.03}, Vec3::Zero(), 0.5);
    }
    of.set_velocities(speed, 5);
    return of;
}

/// `n` links of 1 kg that carry a box of the mass `load`, which presses on a box of 1 kg on the ground
inline BodiesInContact hanging_load(int n, double load)
{
    BodiesInContact of;
    for (int k = 0; k < n; ++k) of.add_box(1, {0.03, 0.03, 0.1});
    const int heavy = of.add_box(load, {0.2, 0.2, 0.2}), light = of.add_box(1, {0.2, 0.2, 0.05});
    of.add_ball(0, -1, {0, 0, 0.1}, Vec3::Zero());
    for (int k = 1; k < n; ++k) of.add_ball(k, k - 1, {0, 0, 0.1}, {0, 0, -0.1});
    of.add_ball(heavy, n - 1, {0, 0, 0.2}, {0, 0, -0.1});
    for (const double a : {-0.2, 0.2})
        for (const double b : {-0.2, 0.2}) {
            of.add_contact(heavy, light, {a, b, -0.2}, {a, b, 0.05}, 0.5);
            of.add_contact(light, -1, {a, b, -0.05}, Vec3::Zero(), 0.5);
        }
    of.set_velocities(0.01, 6);
    of.v[6 * heavy] += 0.1;
    return of;
}

/// Four bodies with random inertia in two layers, which fall on each other and on the ground with random
/// contact points. fall, slip: speeds without the contacts [m/s]
inline BodiesInContact falling(unsigned seed, int contacts, double mu, double fall, double slip)
{
    Random random(seed);
    BodiesInContact of;
    for (int b = 0; b < 4; ++b) {
        const Mat3 A = random.rotation();
        const Vec3 J = Vec3(0.5, 0.5, 0.5) + random.vector(0.3);
        of.mass.m.push_back(random.number(0.5, 2));
        of.mass.J_bar.push_back((A * J.asDiagonal() * A.transpose()).inverse());
    }
    of.v.resize(24);
    for (int b = 0; b < 4; ++b)
        of.v.segment<6>(6 * b) << slip * random.vector() - Vec3(0, 0, fall * (5 - b)), slip * random.vector();
    for (int c = 0; c < contacts; ++c) {
        const int i = c % 4, j = i < 2 ? i + 2 : -1;  // the upper body first, the ground last
        const Vec3 n = (Vec3::UnitZ() + random.vector(0.4)).normalized(),
                   below = Vec3(0, 0, -0.3) + random.vector(0.3);
        of.add_contact(i, j, below, -below, mu, n);
    }
    return of;
}

/// The velocities of the contact points without joints, u = W p + r
struct Delassus {
    Eigen::MatrixXd W;
    Eigen::VectorXd r;

    explicit Delassus(const BodiesInContact& of)
    {
        const auto rows = 3 * static_cast<Eigen::Index>(of.cones.size());
        Eigen::MatrixXd C = Eigen::MatrixXd::Zero(rows, of.v.size()), by_mass = C;
        for (Eigen::Index c = 0; 3 * c < rows; ++c) {
            const ConeRows::Cone& cone = of.cones[static_cast<std::size_t>(c)];
            C.block<3, 6>(3 * c, 6 * cone.i) = cone.C_i;
            if (cone.j >= 0) C.block<3, 6>(3 * c, 6 * cone.j) = cone.C_j;
        }
        for (std::size_t b = 0; b < of.mass.m.size(); ++b) {
            const auto k = 6 * static_cast<Eigen::Index>(b);
            by_mass.middleCols<3>(k) = C.middleCols<3>(k) / of.mass.m[b];
            by_mass.middleCols<3>(k + 3) = C.middleCols<3>(k + 3) * of.mass.J_bar[b].inverse();
        }
        W = by_mass * C.transpose();
        r = C * of.v;
    }
};

/// The largest violations of the equations of the cone problem, in m/s
struct Violations {
    double momentum = 0, joints = 0, impulse = 0, velocity = 0, power = 0;
    double largest() const { return std::max({momentum, joints, impulse, velocity, power}); }
};

/// Evaluates the conditions one by one from the data of the bodies: M v + C_bᵀ λ - Cᵀ p = M v*, C_b v = 0, p
/// in K_μ, û in K_μ* and p · û = 0. Impulses are multiplied by g, and p · û is divided by |p|.
inline Violations violations(const BodiesInContact& of, const Eigen::VectorXd& y, const std::vector<Vec3>& p)
{
    Violations worst;
    const auto raise = [](double& to, double value) {
        if (!(value <= to)) to = value;
    };
    const Eigen::Index n = of.v.size();
    Eigen::VectorXd force = Eigen::VectorXd::Zero(n);
    for (size_t b = 0; b < of.mass.m.size(); ++b) {
        const Eigen::VectorXd change = y.segment<6>(6 * b) - of.v.segment<6>(6 * b);
        force.segment<3>(6 * b) = of.mass.m[b] * change.head<3>();
        force.segment<3>(6 * b + 3) = of.mass.J_bar[b] * change.tail<3>();
    }
    of.rows.add_transpose(1, y.tail(of.rows.rows()), force);
    for (int k = 0; k < of.rows.rows(); ++k) raise(worst.joints, std::abs(of.rows.dot(k, y)));
    for (size_t c = 0; c < of.cones.size(); ++c) {
        const ConeRows::Cone& cone = of.cones[c];
        Vec3 u = cone.C_i * y.segment<6>(6 * cone.i);
        double g = 0;
        const auto add = [&](int b, const ConeRows::Mat36& C) {
            force.segment<6>(6 * b) -= C.transpose() * p[c];
            g += C.leftCols<3>().squaredNorm() / of.mass.m[b] / 3 +
                 (C.rightCols<3>() * of.mass.J_bar[b].inverse() * C.rightCols<3>().transpose()).trace() / 3;
        };
        add(cone.i, cone.C_i);
        if (cone.j >= 0) {
            u += cone.C_j * y.segment<6>(6 * cone.j);
            add(cone.j, cone.C_j);
        }
        const double mu = of.mu[c], slip = u.tail<2>().norm();
        const Vec3 u_hat = u + mu * slip * Vec3::UnitX();
        raise(worst.impulse, g * (p[c].tail<2>().norm() - mu * p[c][0]));
        raise(worst.velocity, mu * slip - u_hat[0]);
        raise(worst.power, std::abs(p[c].dot(u_hat)) / std::max(p[c].norm(), 1e-3 / g));
    }
    for (size_t b = 0; b < of.mass.m.size(); ++b) {
        raise(worst.momentum, force.segment<3>(6 * b).norm() / of.mass.m[b]);
        raise(worst.momentum, (of.mass.J_bar[b].inverse() * force.segment<3>(6 * b + 3)).norm() * 0.1);
    }
    return worst;
}

}  // namespace hilda::tests
