// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/step_check.hpp"

#include "granular/stages/stages.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <numbers>

namespace hilda::granular {

double stability_limit(const World::StepLimits& of)
{
    return std::min(of.rayleigh, 2 / std::numbers::pi * of.collision);
}

void check_step(const Case& c, const StepFinding& above, const StepFinding& coarse)
{
    const World::StepLimits limits = c.world->step_limits();
    const double stable = stability_limit(limits);
    if (c.h > stable)
        above("/step",
              io::formatted("step must not be above %.3g s, the stability limit, got %g", stable, c.h));
    else if (c.h > 0.2 * limits.rayleigh || c.h > limits.collision / 15)
        coarse("/step", io::formatted("%g s is coarse: %.2g of the Rayleigh time, %.2g of the collision time",
                                      c.h, c.h / limits.rayleigh, c.h / limits.collision));
    if (c.stages != nullptr && c.h <= stable)
        c.stages->each_step_limit(*c.world, [&](const std::string& at, const World::StepLimits& of_stage) {
            if (c.h > stability_limit(of_stage))
                above(at, io::formatted(
                              "the stability limit of the step is %.3g s with these laws, the step is %g",
                              stability_limit(of_stage), c.h));
        });
    if (c.end < c.h) c.source.fail("/end", "end must be at least one step, got " + io::shortest(c.end));
}

}  // namespace hilda::granular
