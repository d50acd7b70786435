// SPDX-License-Identifier: GPL-3.0-or-later
/// Counts of a run.

#pragma once

#include <algorithm>

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
    long restitution_reduced = 0;  ///< steps whose coefficients of restitution were reduced, see ContactStep

    /// Adds the counts of an earlier part of the run. The other values become the worse ones of both.
    void add(const Statistics& earlier)
    {
        add_counts(earlier, 1);
        overlap = std::max(overlap, earlier.overlap);
        cone_residual = std::max(cone_residual, earlier.cone_residual);
    }
    void add_counts(const Statistics& of, long factor)
    {
        steps += factor * of.steps, iterations += factor * of.iterations;
        factorizations += factor * of.factorizations, refactorizations += factor * of.refactorizations;
        cone_iterations += factor * of.cone_iterations;
        cone_factorizations += factor * of.cone_factorizations;
        friction_relaxed += factor * of.friction_relaxed;
        restitution_reduced += factor * of.restitution_reduced;
    }

    double iterations_per_step() const
    {
        return steps > 0 ? static_cast<double>(iterations) / static_cast<double>(steps) : 0;
    }
};

}  // namespace hilda::lie
