// SPDX-License-Identifier: GPL-3.0-or-later
/// Where particles begin: on a lattice, packed, at random without touching, or as a table has them.

#pragma once

#include "granular/keys.hpp"

namespace hilda::granular {

struct Filling {
    enum class Kind {
        lattice,  ///< simple cubic
        hcp,      ///< hexagonal, close-packed where the spacing is a diameter
        listed,   ///< by a table
        poisson  ///< at random, no two nearer than the spacing                                        Bridson (2007)
    } kind = Kind::lattice;
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< box of the particles with all of their volume [m]
    double radius = 0, least_radius = 0;     ///< radii are even between the two [m]
    double spacing = 0;                      ///< between centres [m]
    double jitter = 0;     ///< of each coordinate, as a part of what is free between neighbours
    std::size_t most = 0;  ///< particles; 0: as many as fit
    std::uint64_t seed = 1;
    int material = 0;  ///< of those that are listed: -1 where the table says
    std::uint16_t replica = 0;
    Vec3 v = {0, 0, 0};                    ///< [m/s]
    double random_v = 0;                   ///< length of what is added at random [m/s]
    std::vector<Particle> particles = {};  ///< that are listed
    std::uint64_t checksum = 0;            ///< of the table
};

/// InvalidCase
Filling read_filling(Keys& keys);

/// The particles of a table: a line of names, among them x, y, z and radius, and a line for each particle. The columns
/// material (its number), vx, vy, vz, omega_x, omega_y, omega_z, and e0 to e3 may be there too; others are not looked at.
/// InvalidCase, with file and line.
std::vector<Particle> particles_of_csv(const std::string& text, const std::string& file);

/// About as many particles as that will be; a lattice less its count, for random places before it
double estimate(const Filling& filling);

/// The same particles on every machine: the random numbers are our own.
std::vector<Particle> fill(const Filling& filling);

}  // namespace hilda::granular
