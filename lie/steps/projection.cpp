// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/projection.hpp"

#include "lie/check.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

namespace hilda::lie {

int project_positions(const System& system, Saddle& K, State& x, double tolerance)
{
    constexpr int max_iterations = 50;
    constexpr double largest_turn = 0.5;  // of a body in a step [rad]; makes distant positions converge
    double distance = 0;                  // from the origin
    for (const Motion& body : x.body) distance = std::max(distance, body.r.norm());
    tolerance = std::max(tolerance, 8 * std::numeric_limits<double>::epsilon() * distance);
    Eigen::VectorXd step(K.size());
    for (int k = 0;; ++k) {
        const double before = system.position_error(x).value;
        if (!std::isfinite(before))
            throw NonFinite("the projection of the positions: the residual of a constraint is not finite");
        K.assemble(x);
        set_position_residual(system, K, x, step);
        K.solve_refined(step);
        double turn = 0;
        for (int b = 0; b < system.bodies(); ++b) turn = std::max(turn, step.segment<3>(6 * b + 3).norm());
        const State from = x;
        move(K, x, step, turn > largest_turn ? largest_turn / turn : 1);
        // Iterate below the tolerance as long as the residual decreases by a factor of ten. The last step
        // costs little and gives the last digits.
        const System::PositionError after = system.position_error(x);
        if (before <= tolerance && after.value >= 0.1 * before) {
            if (after.value > before) x = from;
            return k;
        }
        if (k == max_iterations) {
            std::ostringstream what;
            what.precision(3);
            what << "the projection of the positions onto the constraints did not converge in "
                 << max_iterations << " steps; largest residual " << after.value << " in "
                 << system.row_name(after.row);
            throw NoConvergence(what.str(), after.value, max_iterations);
        }
    }
}

void project_velocities(const System& system, Saddle& K, State& x)
{
    K.assemble(x);
    Eigen::VectorXd b(K.size());
    set_momenta(system, x, b);
    solve_velocities(system, K, x, b, true);
}

void set_position_residual(const System& system, const Saddle& K, const State& x, Eigen::VectorXd& b)
{
    b.setZero();
    system.phi(x, K.constraint_part(b));
    K.constraint_part(b) *= -1;
}

void move_algebraic(const Rows& C, State& x, const Eigen::Ref<const Eigen::VectorXd>& change, double fraction)
{
    Eigen::Index at = 0;
    for (const Rows::AlgebraicGroup& group : C.algebraic) {
        x.alpha.segment(group.first_alpha, group.count) += fraction * change.segment(at, group.count);
        at += group.count;
    }
}

void move(const Saddle& K, State& x, Eigen::VectorXd& dz, double fraction)
{
    for (size_t i = 0; i < x.body.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        x.body[i].r += fraction * dz.segment<3>(at);
        x.body[i].A = orthonormalised(x.body[i].A * exp(fraction * dz.segment<3>(at + 3)));
    }
    move_algebraic(K.rows(), x, K.algebraic_part(dz), fraction);
}

void set_momenta(const System& system, const State& x, Eigen::VectorXd& b)
{
    const Mass& mass = system.mass();
    for (int i = 0; i < system.bodies(); ++i)
        b.segment<6>(6 * i) << mass.m[i] * x.body[i].rdot, mass.J_bar[i] * x.body[i].omega_bar;
}

void solve_velocities(const System& system, Saddle& K, State& x, Eigen::VectorXd& b, bool refined)
{
    K.algebraic_part(b).setZero();
    system.nu(x, K.constraint_part(b));
    if (refined)
        K.solve_refined(b);
    else
        K.solve_in_step(b);
    set_velocities(x, b);
}

void set_velocities(State& x, const Eigen::VectorXd& v)
{
    for (size_t i = 0; i < x.body.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        x.body[i].rdot = v.segment<3>(at);
        x.body[i].omega_bar = v.segment<3>(at + 3);
    }
}

}  // namespace hilda::lie
