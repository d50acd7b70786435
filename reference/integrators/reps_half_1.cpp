// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit schemes on Euler angles.                                         Fang (2022), Secs. 3.5, 3.9
///
///     reps-half-1        half-implicit (symplectic) Euler, order 1
///     reps-half-1-kick   leapfrog (SHAKE): velocities at half steps, started with half a step, order 2
///
/// Equations: formulations/half_implicit.hpp with the coordinates of formulations/reps.hpp.

#include "reference/formulations/half_implicit.hpp"
#include "reference/formulations/reps.hpp"

namespace hilda::reference {
namespace {

const bool registered_reps_half_1 = register_half_implicit<EulerAngles>("Euler angles", "r, eps, h^2 lambda");

}  // namespace
}  // namespace hilda::reference
