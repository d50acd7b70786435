// SPDX-License-Identifier: GPL-3.0-or-later
/// Settling of grains under their weight: time integration until the kinetic energy is small.

#pragma once

#include "granular/world/world.hpp"

#include <functional>
#include <string>

namespace hilda::granular {

/// Criterion of settled grains
struct Settling {
    std::string what;       ///< subject of the message of an error: "the bed"
    long interval = 1;      ///< between two evaluations of the energy [steps]
    double longest = 0;     ///< from the call on [s]
    double energy = 0;      ///< largest kinetic energy of settled grains over Σ m g R of all [1]
    double shortest = 0.1;  ///< from the call on; grains that start at rest have not settled [s]
};

/// Advances a world for more than the shortest time, until the kinetic energy of its particles is below the
/// limit. Fixed particles do not count. `progress` receives values from 0 to 1. Throws io::NumericalFailure
/// with the status not_settled after the longest time.
void settle(World& world, const Settling& of, const std::function<void(double)>& progress);

}  // namespace hilda::granular
