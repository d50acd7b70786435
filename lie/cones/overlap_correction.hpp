// SPDX-License-Identifier: GPL-3.0-or-later
/// Correction of overlapping bodies: the shortest motion in the metric of the mass that ends the overlaps and
/// keeps the joints closed,
///
///     min |U|_M     subject to  Φ + C_b U = 0,  g_c + C_n U ≥ 0,     q ← q ∘ exp(U)
///
/// It is the cone problem with μ = 0, U in the place of the velocities and g_c in the place of β. It is
/// repeated for the contact points of the corrected poses. Velocities do not change.

#pragma once

#include "lie/cones/cone_solver.hpp"
#include "lie/state.hpp"

namespace hilda::lie {

class System;

class OverlapCorrection {
public:
    explicit OverlapCorrection(const System& system);

    /// Corrects the poses of x until no overlap exceeds 10⁻⁹ of Cone::size, at most five times. Returns false
    /// if a correction was not found; the poses are then those before it.
    bool correct(State& x);

    const ConeSolver& solver() const { return of_positions; }

private:
    void move(State& x) const;

    const System& system;
    Rows C;
    ConeRows overlapping;
    ConeProblem problem;
    ConeSolver of_positions;
    ConeSolver::Iterate iterate;
};

}  // namespace hilda::lie
