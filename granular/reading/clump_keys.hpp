// SPDX-License-Identifier: GPL-3.0-or-later
/// The keys of clumps in a case: templates, single clumps, and clumps of a fill.

#pragma once

#include "granular/backend/split_mix.hpp"
#include "granular/reading/object_reader.hpp"
#include "granular/world/world.hpp"

#include <optional>

namespace hilda::granular {

/// Reads an entry of `clumps` with the number of its material. Throws io::PlacedError.
ClumpTemplate read_clump(ObjectReader& o, const World& world, int material, const Material& properties);

/// Reads an entry of `particles` with the key clump. Throws io::PlacedError.
Clump read_single_clump(ObjectReader& o, const World& world, std::uint16_t replica);

/// The clumps of a fill, one for each particle that the fill generates
class FilledClumps {
public:
    int shape = -1;                                    ///< number of the template; -1: the fill has particles
    double radius = 0;                                 ///< of the sphere around the template [m]
    std::uint32_t spheres = 1;                         ///< of each clump
    std::optional<std::array<double, 4>> orientation;  ///< empty: at random

    explicit operator bool() const { return shape >= 0; }
    /// The clump in place of a particle, whose radius is that of the sphere around the clump. The random
    /// orientations have a sequence of their own, so that places and velocities are those of particles.
    Clump at(const Particle& place, Random& random) const;
};

/// Reads the keys clump and orientation of an entry of `fill`. Throws io::PlacedError.
FilledClumps read_filled_clumps(ObjectReader& o, const World& world);

}  // namespace hilda::granular
