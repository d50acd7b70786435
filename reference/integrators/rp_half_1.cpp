// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit schemes on Euler parameters.                                     Fang (2022), Secs. 3.5, 3.9
///
///     rp-half-1        half-implicit (symplectic) Euler, order 1
///     rp-half-1-kick   leapfrog (SHAKE): velocities at half steps, started with half a step, order 2
///
/// Equations: formulations/half_implicit.hpp with the coordinates of formulations/rp.hpp.

#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"
#include "reference/formulations/half_implicit.hpp"
#include "reference/formulations/rp.hpp"

namespace hilda::reference {
namespace {

class RpHalf1 final : public HalfImplicit<EulerParameters> {
public:
    RpHalf1(const lie::System& model, const lie::Settings& settings)
        : HalfImplicit(model, settings, "rp-half-1", StartMethod::plain)
    {}
};

class RpHalf1Kick final : public HalfImplicit<EulerParameters> {
public:
    RpHalf1Kick(const lie::System& model, const lie::Settings& settings)
        : HalfImplicit(model, settings, "rp-half-1-kick", StartMethod::kick)
    {}
};

const bool registered =
    lie::register_scheme<RpHalf1>({.name = "rp-half-1",
                                   .description = "half-implicit (symplectic) Euler on Euler parameters",
                                   .order = 1,
                                   .order_lambda = 1,
                                   .formulation = "rp",
                                   .unknowns = "r, p, h^2 lambda, h^2 lambda_P",
                                   .source = "Fang (2022), Secs. 3.5, 3.9"});

const bool registered_kick =
    lie::register_scheme<RpHalf1Kick>({.name = "rp-half-1-kick",
                                       .description = "leapfrog (SHAKE) on Euler parameters",
                                       .order = 2,
                                       .order_lambda = 2,
                                       .formulation = "rp",
                                       .unknowns = "r, p, h^2 lambda, h^2 lambda_P",
                                       .source = "Fang (2022), Secs. 3.5, 3.9, half-step start"});

}  // namespace
}  // namespace hilda::reference
