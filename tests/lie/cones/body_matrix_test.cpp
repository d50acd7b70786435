// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/body_matrix.hpp"
#include "tests/lie/cones/cone_problems.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// The matrix of BodyMatrix without ε, dense
Eigen::MatrixXd dense(const tests::BodiesInContact& of, const std::vector<Mat3>& W)
{
    const Eigen::Index n = of.v.size(), rows = of.rows.rows();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + rows, n + rows);
    for (size_t b = 0; b < of.mass.m.size(); ++b) {
        K.block<3, 3>(6 * b, 6 * b) = of.mass.m[b] * Mat3::Identity();
        K.block<3, 3>(6 * b + 3, 6 * b + 3) = of.mass.J_bar[b];
    }
    for (size_t c = 0; c < of.cones.size(); ++c) {
        Eigen::MatrixXd C = Eigen::MatrixXd::Zero(3, n + rows);
        C.middleCols<6>(6 * of.cones[c].i) += of.cones[c].C_i;
        if (of.cones[c].j >= 0) C.middleCols<6>(6 * of.cones[c].j) += of.cones[c].C_j;
        K += C.transpose() * W[c] * C;
    }
    for (int k = 0; k < rows; ++k)
        for (int e = of.rows.start[k]; e < of.rows.start[k + 1]; ++e) {
            Eigen::Matrix<double, 6, 1> entry;
            entry << of.rows.entry[e].r, of.rows.entry[e].pi;
            K.block<1, 6>(n + k, 6 * of.rows.entry[e].body) = entry.transpose();
            K.block<6, 1>(6 * of.rows.entry[e].body, n + k) = entry;
        }
    return K;
}

}  // namespace

TEST_CASE("the matrix of bodies and contact points solves as the dense one", "[lie][cones]")
{
    for (const auto& of : {tests::stack(4), tests::chain(5, 100, 0.1), tests::hanging_load(3, 10)}) {
        const lie::ConeProblem problem = of.problem();
        lie::BodyMatrix matrix(of.mass, of.rows);
        matrix.set_contacts(problem);
        std::vector<Mat3> W(of.cones.size());
        std::mt19937 random(1);
        std::normal_distribution<double> normal;
        for (const bool symmetric : {true, false}) {
            for (Mat3& block : W) {
                const Mat3 a = Mat3::NullaryExpr([&] { return normal(random); });
                block = 10 * a * a.transpose();
                if (!symmetric) block.row(0) += Vec3(0, normal(random), normal(random)).transpose();
            }
            const Eigen::MatrixXd K = dense(of, W);
            const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(K.rows(), [&] { return normal(random); });
            Eigen::VectorXd y(K.rows());
            matrix.factor(problem, W);
            matrix.solve(b, y);
            INFO(of.cones.size() << " contact points, symmetric " << symmetric);
            CHECK((K * y - b).norm() < 1e-9 * b.norm());
        }
        // other pairs of bodies: the last contact point is left out
        auto fewer = of;
        fewer.cones.pop_back();
        fewer.mu.pop_back();
        W.pop_back();
        const lie::ConeProblem other = fewer.problem();
        matrix.set_contacts(other);
        matrix.factor(other, W);
        const Eigen::MatrixXd K = dense(fewer, W);
        const Eigen::VectorXd b = Eigen::VectorXd::Ones(K.rows());
        Eigen::VectorXd y(K.rows());
        matrix.solve(b, y);
        CHECK((K * y - b).norm() < 1e-9 * b.norm());
    }
}

TEST_CASE("dependent joint rows leave the velocities determined", "[lie][cones]")
{
    tests::BodiesInContact of = tests::chain(3, 1, 0.1), twice = of;
    twice.add_ball(1, 0, {-0.1, 0, 0}, {0.1, 0, 0});  // a second time
    const lie::ConeProblem once = of.problem(), again = twice.problem();
    lie::BodyMatrix a(of.mass, of.rows), b(twice.mass, twice.rows);
    a.factor_joints(once);
    b.factor_joints(again);
    Eigen::VectorXd right(once.unknowns()), other(again.unknowns()), v(once.unknowns()), w(again.unknowns());
    const std::vector<Vec3> none(of.cones.size(), Vec3::Zero());
    once.set_right_side(none, right);
    again.set_right_side(none, other);
    a.solve(right, v);
    b.solve(other, w);
    CHECK((v.head(18) - w.head(18)).norm() < 1e-9 * v.head(18).norm());
    CHECK(again.joint_residual(w) < 1e-12);
}
