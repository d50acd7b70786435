// SPDX-License-Identifier: GPL-3.0-or-later
/// The same laws and schemes in double precision, for few particles: what World is compared with.

#pragma once

#include "granular/world/world.hpp"

#include <map>

namespace hilda::granular {

/// All pairs are looked at, one by one. Not periodic.
class DoubleWorld {
public:
    DoubleWorld(const WorldOptions& options, const PairLaw& law) : options(options), law(law) {}

    void step(long n = 1);

    std::vector<Particle> particle;  ///< with their masses set; a fixed one keeps its velocity
    std::vector<Boundary> boundary;
    bool turns = true;

private:
    void find_loads();

    WorldOptions options;
    PairLaw law;
    std::map<std::pair<int, int>, History<double>>
        history;  ///< of those that touch; boundaries as -1 - number
    std::vector<Vec3> F, T, a, alpha;
    long number = 0;
};

}  // namespace hilda::granular
