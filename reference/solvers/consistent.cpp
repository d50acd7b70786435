// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/consistent.hpp"

#include "dae/start.hpp"

#include <algorithm>

namespace hilda::reference {

void project(const lie::System& system, lie::Saddle& K, lie::State& x)
{
    constexpr int most = 10;
    constexpr double converged = 1e-13, close = 1e-9;  // of the step, relative to the largest |r| [m, rad]
    Eigen::VectorXd step(K.size());
    double before = 0;
    for (int k = 1; system.rows() > 0; ++k) {
        K.assemble(x);
        step.setZero();
        system.phi(x, K.constraint_part(step));
        step *= -1;
        K.solve_refined(step);
        double length = 0, size = 1;
        for (int b = 0; b < system.bodies(); ++b) {
            length = std::max(length, step.segment<6>(6 * b).norm());
            size = std::max(size, x.body[b].r.norm());
        }
        if (k > 1 && length > before && length < converged * size)
            break;  // rounding: the last one was better
        for (int b = 0; b < system.bodies(); ++b) {
            x.body[b].r += step.segment<3>(6 * b);
            x.body[b].A = lie::orthonormalised(x.body[b].A * lie::exp(step.segment<3>(6 * b + 3)));
        }
        // Near a singular position rounding alone moves by more than the first.
        if (length < converged * size || (k > 1 && length < close * size && length > 0.1 * before)) break;
        if (k == most)
            throw lie::NoConvergence("the state cannot be moved onto its constraints", length, most);
        before = length;
    }
    dae::project_velocities(system, K, x);
}

}  // namespace hilda::reference
