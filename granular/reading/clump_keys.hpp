// SPDX-License-Identifier: GPL-3.0-or-later
/// The keys of clumps in a case: templates, single clumps, and clumps in the places of particles.

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

/// The clumps of a fill or an insertion, each in the place of a particle
class PlacedClumps {
public:
    int shape = -1;                                    ///< number of the template; -1: particles, no clumps
    ClumpTemplate of;                                  ///< the template
    double radius = 0;                                 ///< of the sphere around the template [m]
    std::optional<std::array<double, 4>> orientation;  ///< empty: at random

    explicit operator bool() const { return shape >= 0; }
    double spheres() const { return static_cast<double>(of.spheres.size()); }  ///< number of each clump
    /// The clump in place of a particle, whose radius is that of the sphere around the clump. A random
    /// orientation takes three random numbers.
    Clump at(const Particle& place, Random& random) const;
};

/// Notes the keys clump and orientation of an entry of `fill` or `insert` for the schema. `about_clump`:
/// description of the first one
void note_clumps(ObjectReader& o, const char* about_clump);
/// Reads these keys. Throws io::PlacedError.
PlacedClumps read_placed_clumps(ObjectReader& o, const World& world);

}  // namespace hilda::granular
