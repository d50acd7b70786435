// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_problem.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace hilda::lie {

ConeProblem::ConeProblem(const Mass& mass, const Rows& pattern) : mass(mass), C_b(&pattern)
{
    for (const Mat3& J_bar : mass.J_bar) J_bar_inverse.push_back(J_bar.inverse());
    q.setZero(6 * bodies());
    nu.setZero(pattern.rows());
}

ConeProblem::Vec6 ConeProblem::by_mass(int b, const Vec6& of) const
{
    Vec6 v;
    v << of.head<3>() / mass.m[b], J_bar_inverse[b] * of.tail<3>();
    return v;
}

ConeProblem::Vec6 ConeProblem::times_mass(int b, const Vec6& of) const
{
    Vec6 v;
    v << mass.m[b] * of.head<3>(), mass.J_bar[b] * of.tail<3>();
    return v;
}

void ConeProblem::set_scales()
{
    g.resize(cones->size());
    for (int c = 0; c < contacts(); ++c) {
        const ConeRows::Cone& cone = (*cones)[c];
        const auto of_body = [&](int b, const ConeRows::Mat36& C) {
            double sum = 0;
            if (b < 0) return sum;
            for (int k = 0; k < (mu[c] > 0 ? 3 : 1); ++k) {
                const Vec6 row = C.row(k).transpose();
                sum += row.dot(by_mass(b, row));
            }
            return sum;
        };
        const double sum = of_body(cone.i, cone.C_i) + of_body(cone.j, cone.C_j);  // the same if exchanged
        g[c] = mu[c] > 0 ? sum / 3 : sum;
    }
}

Vec3 ConeProblem::u(int c, const Eigen::VectorXd& y) const
{
    const ConeRows::Cone& cone = (*cones)[c];
    Vec3 sum = Vec3::Zero();
    if (cone.i >= 0) sum += cone.C_i * y.segment<6>(6 * cone.i);
    if (cone.j >= 0) sum += cone.C_j * y.segment<6>(6 * cone.j);
    return sum;
}

void ConeProblem::add_impulse(int c, const Vec3& p, Eigen::VectorXd& out) const
{
    const ConeRows::Cone& cone = (*cones)[c];
    if (cone.i >= 0) out.segment<6>(6 * cone.i) += cone.C_i.transpose() * p;
    if (cone.j >= 0) out.segment<6>(6 * cone.j) += cone.C_j.transpose() * p;
}

void ConeProblem::set_right_side(const std::vector<Vec3>& p, Eigen::VectorXd& out) const
{
    out.head(q.size()) = q;
    out.tail(nu.size()) = nu;
    for (int c = 0; c < contacts(); ++c) add_impulse(c, p[c], out);
}

double ConeProblem::joint_residual(const Eigen::VectorXd& y) const
{
    double largest = 0;
    for (int k = 0; k < C_b->rows(); ++k) {
        const double error = std::abs(C_b->dot(k, y) - nu[k]);
        if (!(error <= largest)) largest = error;  // also NaN
    }
    return largest;
}

double ConeProblem::residual(const Iterate& x) const
{
    double largest = joint_residual(x.y);
    for (int c = 0; c < contacts(); ++c) {
        const double error = natural_map(c, x.p[c], u_hat(c, x.y));
        if (!(error <= largest)) largest = error;
    }
    return largest;
}

double ConeProblem::convex_residual(const Iterate& x) const
{
    double largest = joint_residual(x.y);
    for (int c = 0; c < contacts(); ++c) {
        Vec3 w = u(c, x.y);
        w[0] += x.offset[c];
        const double error = natural_map(c, x.p[c], w);
        if (!(error <= largest)) largest = error;
    }
    return largest;
}

int ConeProblem::worst_contact(const Iterate& x) const
{
    int worst = contacts() > 0 ? 0 : -1;
    double largest = 0;
    for (int c = 0; c < contacts(); ++c) {
        const double error = natural_map(c, x.p[c], u_hat(c, x.y));
        if (error > largest) largest = error, worst = c;
    }
    return worst;
}

}  // namespace hilda::lie
