// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-dp-5: the Runge-Kutta method 5(4) of Dormand and Prince on the index-1 equations, with projection.
///
/// Dormand, Prince (1980), J. Comput. Appl. Math. 6, 19-26. The continuous extension of order 4 is that of
/// DOPRI5: Hairer, Nørsett, Wanner (1993), Sec. II.6. lie/steps/local_coordinate_step.hpp has the variables
/// and the projection.

#include "lie/steps/adaptive_step.hpp"

namespace hilda::lie {

const Tableau& dormand_prince_5()
{
    // clang-format off
    static const Tableau tableau = {
        .name = "rA-dp-5",
        .order = 5,
        .c = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1},
        .a = {{},
              {1. / 5},
              {3. / 40, 9. / 40},
              {44. / 45, -56. / 15, 32. / 9},
              {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
              {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
              {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}},
        .error = {{71. / 57600, 0, -71. / 16695, 71. / 1920, -17253. / 339200, 22. / 525, -1. / 40}},
        .dense = {{-12715105075. / 11282082432, 0, 87487479700. / 32700410799, -10690763975. / 1880347072,
                   701980252875. / 199316789632, -1453857185. / 822651844, 69997945. / 29380423}}};
    // clang-format on
    return tableau;
}

namespace {

const bool registered_dp_5 = register_with_adaptive_steps<RungeKuttaStep, dormand_prince_5>(
    {.name = "rA-dp-5",
     .description = "explicit Runge-Kutta 5(4) of Dormand and Prince with projection; adaptive or fixed step",
     .order = 5,
     .order_lambda = 5,
     .formulation = "rA",
     .unknowns = "none; projection",
     .uses = newton_options,
     .source = "Dormand, Prince (1980), with projection",
     .stability = 1,
     .supports = {Feature::algebraic, Feature::nonholonomic, Feature::redundant, Feature::history}});

}  // namespace
}  // namespace hilda::lie
