// SPDX-License-Identifier: GPL-3.0-or-later
/// Initial particles: on a lattice, close-packed, at random without contact, or from a table.

#pragma once

#include "granular/case/object_reader.hpp"

namespace hilda::granular {

/// An entry of `fill`
struct FillSpec {
    enum class Type {
        lattice,  ///< simple cubic
        hcp,      ///< hexagonal layers; close-packed if the spacing is one diameter
        csv,      ///< read from a table
        poisson   ///< Poisson disk sampling: random, no two centres closer than the spacing; Bridson (2007)
    } type = Type::lattice;
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< corners of the box that contains the spheres [m]
    double radius = 0, least_radius = 0;     ///< radii are uniformly distributed between the two [m]
    double spacing = 0;                      ///< distance of neighbouring centres [m]
    double jitter = 0;          ///< random displacement over the largest one without contact, in [0, 1]
    std::size_t max_count = 0;  ///< largest number of particles; 0: no limit
    std::uint64_t seed = 1;
    int material = 0;  ///< index; -1 with Type::csv: as in the table
    std::uint16_t replica = 0;
    Vec3 v = {0, 0, 0};                    ///< [m/s]
    double random_v = 0;                   ///< magnitude of an added velocity of random direction [m/s]
    std::vector<Particle> particles = {};  ///< particles of the table, with Type::csv
    std::uint64_t checksum = 0;            ///< of the table file
};

/// Reads an entry of `fill`, without material and replica. Throws io::InvalidInput.
FillSpec read_fill(ObjectReader& o);

/// Reads particles from a table (CSV) such as the particles.csv of a run: a line of column names and one line
/// per particle. Required columns: x, y, z, radius. Optional columns: material (index), vx, vy, vz, omega_x,
/// omega_y, omega_z, e0 to e3. Other columns are ignored. SI units, global frame. Throws io::InvalidInput with
/// file and line.
std::vector<Particle> particles_of_csv(const std::string& text, const std::string& file);

/// Estimated number of particles. For Type::poisson max_count is ignored, because all positions are generated
/// first.
double estimated_count(const FillSpec& filling);

/// Generates the particles. The result is the same on all platforms (see SplitMix). Throws io::InvalidInput.
std::vector<Particle> fill(const FillSpec& filling);

}  // namespace hilda::granular
