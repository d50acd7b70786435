// SPDX-License-Identifier: GPL-3.0-or-later
/// Parameters of a case that change during a run: gravity, laws, motions and loads of boundaries, insertions.

#pragma once

#include "granular/case/case_file.hpp"

namespace hilda::granular {

/// Gives the world of `c` the parameters that `changed` has at these pointers. `changed`
/// has the same materials, laws, boundaries and insertions, and was read without particles. `start` is the
/// time t = 0 of its formulas [s]. Throws io::PlacedError at the entry of `changed` if a law is another one.
void take_over(Case& c, const Case& changed, const std::vector<std::string>& pointers, double start = 0);

/// At the instant of a change, after take_over() with the same arguments: sets the velocities, forces and
/// torques that are numbers, begins the flows of insertions that have changed, and begins the balance
/// of the watch again. Throws io::PlacedError at the entry of `changed` if a boundary is not at the place of
/// its new formula.
void begin_change(Case& c, const Case& changed, const std::vector<std::string>& pointers);

}  // namespace hilda::granular
