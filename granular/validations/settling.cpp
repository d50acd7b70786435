// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/settling.hpp"

#include "io/error.hpp"
#include "io/message.hpp"

namespace hilda::granular {

void settle(World& world, const Settling& of, const std::function<void(double)>& progress)
{
    while (true) {
        world.step(of.interval);
        progress(world.t() / of.longest);
        const double energy = world.kinetic_energy() / of.unit;
        if (world.t() > 0.1 && energy < of.energy) return;
        if (world.t() > of.longest)
            throw io::NumericalFailure(
                "not_settled", io::formatted("%s has not settled after %g s: %.3g m g R per grain, and %g is "
                                             "allowed",
                                             of.what.c_str(), of.longest, energy, of.energy));
    }
}

}  // namespace hilda::granular
