// SPDX-License-Identifier: GPL-3.0-or-later
/// Parameters of a case that change during a run: gravity, laws, motions and loads of boundaries, insertions.

#pragma once

#include "granular/case/case_file.hpp"

namespace hilda::granular {

/// The values in a case of the entries that can change, without its particles and meshes
struct CaseParameters {
    /// Velocities and loads of a boundary, where they are numbers
    struct Numbers {
        Vec3 v, omega, F, T;
    };

    Vec3 gravity = {0, 0, 0};
    std::vector<PairLaw> laws;
    std::vector<BoundaryMotion> motions;  ///< formulas of the boundaries that have some
    std::vector<Numbers> numbers;         ///< by boundary
    std::vector<InsertionFlow> flows;     ///< by insertion
    std::vector<int> moving;              ///< numbers of the boundaries that move
};

CaseParameters parameters_of(const Case& c);

/// Checks whether a run of `c` can have the values of `changed` at these pointers. `changed` is of a case
/// with the same materials, boundaries and insertions. Throws io::PlacedError at an entry of c.source if a
/// law is another one, or if a velocity is along a free axis.
void check_parameters(const Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers);

/// Gives the world of `c` the values of `changed` at these pointers that are not part of its state: gravity,
/// laws and formulas. `start` is the time t = 0 of the formulas [s].
void set_parameters(Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers,
                    double start = 0);

/// At the instant of a change, after set_parameters() with the same arguments: sets the velocities, forces
/// and torques that are numbers, begins the flows of insertions that have changed, and begins the balance of
/// the watch again. Throws io::PlacedError at an entry of c.source if a boundary is not at the place of its
/// new formula.
void begin_change(Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers);

}  // namespace hilda::granular
