// SPDX-License-Identifier: GPL-3.0-or-later
/// Counts of a run.

#pragma once

namespace hilda::lie {

/// Numbers of steps, iterations and factorisations of an integrator
struct Statistics {
    long steps = 0;
    long iterations = 0;        ///< of Newton's method
    long factorizations = 0;    ///< with a new choice of pivots
    long refactorizations = 0;  ///< with earlier pivots of KLU, or by the condensed solver
    double correction = 0;      ///< norm of the last correction, in the units of Settings::tolerance
    double condition = 1;       ///< reciprocal condition of the last matrix; 1 for a scheme without matrix
    long cone_iterations = 0;   ///< of the methods for rigid contacts
    long cone_factorizations = 0;
    double overlap = 0;         ///< largest one that a correction has left, relative to ConeRows::Cone::size
    double cone_residual = 0;   ///< largest residual of the contact law [m/s]
    long friction_relaxed = 0;  ///< steps with ConeSolver::Status::friction_relaxed

    double iterations_per_step() const
    {
        return steps > 0 ? static_cast<double>(iterations) / static_cast<double>(steps) : 0;
    }
};

}  // namespace hilda::lie
