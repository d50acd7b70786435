// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/effective_mass.hpp"

#include "lie/system.hpp"

#include <Eigen/Eigenvalues>

#include <limits>

namespace hilda::run {

EffectiveMass::EffectiveMass(const lie::System& system) : system(system), K(system), z(K.size()) {}

double EffectiveMass::operator()(const lie::State& x, int body)
{
    K.assemble(x);
    lie::Mat3 Y;
    for (int axis = 0; axis < 3; ++axis) {
        z = Eigen::VectorXd::Unit(K.size(), 6 * body + axis);
        K.solve_in_step(z);
        Y.col(axis) = z.segment<3>(6 * body);
    }
    const lie::Mat3 symmetric = 0.5 * (Y + Y.transpose());
    const double largest = Eigen::SelfAdjointEigenSolver<lie::Mat3>(symmetric).eigenvalues().maxCoeff(),
                 free = 1 / system.mass().m[static_cast<size_t>(body)], rounding = 1e-12 * free;
    return largest > rounding ? 1 / largest : std::numeric_limits<double>::infinity();
}

}  // namespace hilda::run
