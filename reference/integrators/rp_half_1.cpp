// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit schemes on Euler parameters.                                     Fang (2022), Secs. 3.5, 3.9
///
///     rp-half-1        half-implicit (symplectic) Euler, order 1
///     rp-half-1-kick   leapfrog (SHAKE): velocities at half steps, started with half a step, order 2
///
/// Equations: formulations/half_implicit.hpp with the coordinates of formulations/rp.hpp.

#include "reference/formulations/half_implicit.hpp"
#include "reference/formulations/rp.hpp"

namespace hilda::reference {
namespace {

const bool registered_rp_half_1 =
    register_half_implicit<EulerParameters>("Euler parameters", "r, p, h^2 lambda, h^2 lambda_P");

}  // namespace
}  // namespace hilda::reference
