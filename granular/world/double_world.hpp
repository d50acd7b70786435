// SPDX-License-Identifier: GPL-3.0-or-later
/// Double-precision reference of World: the same laws and schemes for few particles, for comparison in tests
/// and validations.

#pragma once

#include "granular/world/world.hpp"

#include <map>

namespace hilda::granular {
/// Tests all pairs for contact, so a step takes O(n²) operations. The domain is unbounded and not periodic.
/// Boundaries move with their prescribed velocities; contact forces do not accelerate them.
class DoubleWorld {
public:
    DoubleWorld(const WorldOptions& options, const PairLaw& law) : options(options), law(law) {}

    /// Computes n steps.
    void step(long n = 1);

    std::vector<Particle> particle;  ///< masses must be set; the velocities of fixed particles stay constant
    std::vector<Boundary> boundary;
    bool turns = true;  ///< false: torques do not accelerate the rotation of particles

private:
    void find_loads(double lag);

    WorldOptions options;
    PairLaw law;
    std::map<std::pair<int, int>, History<double>>
        history;  ///< of the pairs in contact, i < j; boundary b has the index -1 - b
    std::vector<Vec3> F, T, a, alpha;
    long step_count = 0;
};

}  // namespace hilda::granular
