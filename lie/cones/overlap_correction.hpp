// SPDX-License-Identifier: GPL-3.0-or-later
/// Correction of overlapping bodies: the shortest motion in the metric of the mass that ends the overlaps and
/// keeps the joints closed,
///
///     min |U|_M     subject to  Φ + C_b U = 0,  g_c + C_n U ≥ 0,     q ← q ∘ exp(U)
///
/// It is the cone problem with μ = 0, U in the place of the velocities and g_c in the place of β. It is
/// repeated for the contact points of the corrected poses. Velocities do not change.

#pragma once

#include "lie/cones/cone_islands.hpp"
#include "lie/state.hpp"

namespace hilda::lie {

class System;

class OverlapCorrection {
public:
    /// `tolerance`: of Φ after a correction [m or rad]
    OverlapCorrection(const System& system, double tolerance);

    static constexpr double allowed = 1e-9;  ///< overlap, relative to Cone::size

    /// The contact points of x that touch or overlap. A call of correct() for the same x takes them.
    const ConeRows& find(const State& x);
    /// Corrects the poses of x until no overlap exceeds 10⁻⁹ of Cone::size and the joints are closed, at most
    /// ten times. The gaps of the contact points in reach of a step h, and of those of the corrections
    /// before, remain positive. Returns false if a correction was not found; the poses are then those before
    /// it.
    bool correct(State& x, double h);

    /// Largest overlap after a correction, relative to Cone::size
    double remaining() const { return remaining_overlap; }
    const ConeIslands& solver() const { return of_positions; }

private:
    void move(State& x) const;

    const System& system;
    const double tolerance;
    Rows C;
    ConeRows contacts;
    ConeRows overlapping;  ///< contact points that overlap
    ConeRows before;       ///< those of the last correction, with the gaps after it
    ConeProblem problem;
    ConeIslands of_positions;
    ConeIslands::Iterate iterate;
    std::vector<double> start_tolerance;  ///< of each contact point [m]
    bool is_found = false;                ///< contacts are those of find()
    double remaining_overlap = 0;
};

}  // namespace hilda::lie
