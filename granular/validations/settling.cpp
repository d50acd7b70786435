// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/settling.hpp"

#include "io/error.hpp"
#include "io/message.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

/// Σ m g R of the particles that are not fixed [J]
double energy_unit(const World& world)
{
    double sum = 0;
    world.each_particle([&](const Particle& p) { sum += p.fixed ? 0 : p.mass * p.radius; });
    return sum * world.gravity().norm();
}

}  // namespace

void settle(World& world, const Settling& of, const std::function<void(double)>& progress)
{
    const double start = world.t();
    double unit = 0;
    while (true) {
        world.step(of.interval);
        if (unit == 0) unit = energy_unit(world);  // the first step inserts the particles
        const double time = world.t() - start, energy = world.kinetic_energy() / unit;
        progress(std::min(1., time / of.longest));
        if (time > of.shortest && energy < of.energy) return;
        if (time > of.longest)
            throw io::NumericalFailure(
                "not_settled", io::formatted("%s has not settled after %g s: %.3g m g R per grain, and %g is "
                                             "allowed",
                                             of.what.c_str(), of.longest, energy, of.energy));
    }
}

}  // namespace hilda::granular
