// SPDX-License-Identifier: GPL-3.0-or-later
/// Materials of the comparison of ten codes for bulk processes (Dosta et al. 2024, Comput. Phys. Commun. 296,
/// 109066).
///
/// The parameters are those of the input files of MercuryDPM (Drivers/Papers/OSBenchmark) and YADE
/// (examples/DEM2020Benchmark). For the pair steel and steel YADE has 0.4 and 0.2.
///
///     M1:     2500 kg/m³, 1 GPa,   ν = 0.2        M2: 2000 kg/m³, 0.5 GPa, ν = 0.2
///     steel:  7200 kg/m³, 210 GPa, ν = 0.2
///
///     pair            M1-M1   M1-M2   M1-steel   M2-M2   M2-steel   steel-steel
///     restitution      0.5     0.45     0.4       0.4      0.4        0.6
///     friction         0.3     0.2      0.2       0.4      0.2        0.5

#pragma once

#include "granular/backend/split_mix.hpp"
#include "granular/validations/bed_geometry.hpp"
#include "granular/world/world.hpp"

#include <functional>
#include <vector>

namespace hilda::granular {

enum BulkMaterial { M1, M2, steel };

/// How a run differs from the published one. The geometry is the published one.
struct BulkScale {
    double size = 1;      ///< diameter of the grains over the published one
    double softness = 1;  ///< published Young's moduli over those of the run

    /// A published number of grains, divided by size³
    long number(long published) const;
};

/// M1, M2 and steel
std::vector<Material> bulk_materials(const BulkScale& scale);
/// Hertz and Mindlin with the published coefficients, for all pairs
void set_bulk_laws(World& world, const BulkScale& scale);

/// 0.16 of the Rayleigh time of a grain of this radius [s]. The published steps are 0.06 to 0.09 of it.
double bulk_step(double radius, BulkMaterial material, const BulkScale& scale);

/// Copies of a grain on a loose cubic lattice with random displacements and velocities, layer by layer from
/// the height `low` of their lowest points on: the places that are inside. The lattice covers |x| and |y| up
/// to `half`.
std::vector<Particle> loose_layers(const Particle& grain, long count, double low, double half,
                                   const std::function<bool(const Vec3&)>& inside, Random& random);

}  // namespace hilda::granular
