// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit schemes on Euler angles.                                         Fang (2022), Secs. 3.5, 3.9
///
///     reps-half-1        half-implicit (symplectic) Euler, order 1
///     reps-half-1-kick   leapfrog (SHAKE): velocities at half steps, started with half a step, order 2
///
/// Equations: formulations/half_implicit.hpp with the coordinates of formulations/reps.hpp.

#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"
#include "reference/formulations/half_implicit.hpp"
#include "reference/formulations/reps.hpp"

namespace hilda::reference {
namespace {

class RepsHalf1 final : public HalfImplicit<EulerAngles> {
public:
    RepsHalf1(const lie::System& model, const lie::Settings& settings)
        : HalfImplicit(model, settings, "reps-half-1", StartMethod::plain)
    {}
};

class RepsHalf1Kick final : public HalfImplicit<EulerAngles> {
public:
    RepsHalf1Kick(const lie::System& model, const lie::Settings& settings)
        : HalfImplicit(model, settings, "reps-half-1-kick", StartMethod::kick)
    {}
};

const bool registered =
    lie::register_scheme<RepsHalf1>({.name = "reps-half-1",
                                     .description = "half-implicit (symplectic) Euler on Euler angles",
                                     .order = 1,
                                     .order_lambda = 1,
                                     .formulation = "reps",
                                     .unknowns = "r, eps, h^2 lambda",
                                     .source = "Fang (2022), Secs. 3.5, 3.9"});

const bool registered_kick =
    lie::register_scheme<RepsHalf1Kick>({.name = "reps-half-1-kick",
                                         .description = "leapfrog (SHAKE) on Euler angles",
                                         .order = 2,
                                         .order_lambda = 2,
                                         .formulation = "reps",
                                         .unknowns = "r, eps, h^2 lambda",
                                         .source = "Fang (2022), Secs. 3.5, 3.9, half-step start"});

}  // namespace
}  // namespace hilda::reference
