// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/forces/spring_limits.hpp"

#include "dae/model.hpp"
#include "lie/linear_springs.hpp"
#include "lie/solver/saddle.hpp"

namespace hilda::dae {

namespace {

constexpr double rounding = 1e-10;  // of W, relative to that of free bodies: the constraints permit no motion

}  // namespace

double free_mobility(const lie::Mass& mass, int body, const Vec3& r, const Vec3& pi)
{
    return r.squaredNorm() / mass.m[body] + pi.dot(mass.J_bar[body].inverse() * pi);
}

void set_spring_limits(const Model& model, lie::Saddle& K, const State& x)
{
    const lie::Mass& mass = model.mass();
    Eigen::VectorXd b(K.size());
    for (const auto& force : model.forces()) {
        force->spring_limits = {};
        std::vector<Force::SpringRow> rows(static_cast<size_t>(force->max_spring_rows()));
        rows.resize(static_cast<size_t>(force->spring_rows(x, rows.data())));
        const auto n = static_cast<Eigen::Index>(rows.size());
        if (n == 0) continue;
        const auto [i, j] = force->bodies();
        lie::LinearSprings<Eigen::Dynamic> springs;
        springs.W.resize(n, n), springs.K.resize(n), springs.D.resize(n);
        auto& W = springs.W;
        for (Eigen::Index column = 0; column < n; ++column) {
            const Force::SpringRow& row = rows[static_cast<size_t>(column)];
            springs.K[column] = row.stiffness, springs.D[column] = row.damping;
            double free = 0;  // inverse effective mass of the bodies without constraints
            b.setZero();
            const auto set = [&](int body, const Vec3& r, const Vec3& pi) {
                if (body == ground) return;
                b.segment<3>(6 * body) = r, b.segment<3>(6 * body + 3) = pi;
                free += free_mobility(mass, body, r, pi);
            };
            set(i, row.r_i, row.pi_i);
            set(j, row.r_j, row.pi_j);
            K.solve_in_step(b);
            const auto along = [&](int body, const Vec3& r, const Vec3& pi) {
                return body == ground ? 0
                                      : r.dot(b.segment<3>(6 * body)) + pi.dot(b.segment<3>(6 * body + 3));
            };
            for (Eigen::Index other = 0; other < n; ++other) {
                const Force::SpringRow& of = rows[static_cast<size_t>(other)];
                W(other, column) = along(i, of.r_i, of.pi_i) + along(j, of.r_j, of.pi_j);
            }
            if (!(W(column, column) > rounding * free)) W(column, column) = 0;
        }
        W = (0.5 * (W + W.transpose())).eval();
        force->spring_limits = {springs.stable_step(lie::damping_factor(LoadEvaluation::at_step)),
                                springs.stable_step(lie::damping_factor(LoadEvaluation::extrapolated))};
    }
}

}  // namespace hilda::dae
