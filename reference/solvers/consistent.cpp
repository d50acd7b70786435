// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/consistent.hpp"

#include "dae/start.hpp"
#include "lie/check.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <algorithm>

namespace hilda::reference {

void project(const lie::System& system, lie::Saddle& K, lie::State& x)
{
    constexpr int max_iterations = 10;
    constexpr double converged = 1e-13, stagnation = 1e-9;  // correction / max(1, |r|) [m, rad]
    Eigen::VectorXd correction(K.size());
    double previous = 0;
    for (int k = 1; system.rows() > 0; ++k) {
        K.assemble(x);
        correction.setZero();
        system.phi(x, K.constraint_part(correction));
        correction *= -1;
        K.solve_refined(correction);
        double length = 0, size = 1;
        for (int b = 0; b < system.bodies(); ++b) {
            length = std::max(length, correction.segment<6>(6 * b).norm());
            size = std::max(size, x.body[b].r.norm());
        }
        if (k > 1 && length > previous && length < converged * size)
            break;  // rounding: the correction does not decrease further
        for (int b = 0; b < system.bodies(); ++b) {
            x.body[b].r += correction.segment<3>(6 * b);
            x.body[b].A = lie::orthonormalised(x.body[b].A * lie::exp(correction.segment<3>(6 * b + 3)));
        }
        // Near a singular position rounding errors keep the correction above `converged`. The second
        // condition stops if a small correction decreases by less than a factor of 10.
        if (length < converged * size || (k > 1 && length < stagnation * size && length > 0.1 * previous))
            break;
        if (k == max_iterations)
            throw lie::NoConvergence(
                "reference::project: the projection onto the constraints does not converge; "
                "the initial state must be closer to them",
                length, max_iterations);
        previous = length;
    }
    dae::project_velocities(system, K, x);
}

}  // namespace hilda::reference
