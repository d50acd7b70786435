// SPDX-License-Identifier: GPL-3.0-or-later
/// Geometry of a bed of spheres on a floor at z = 0.

#pragma once

#include "granular/world/world.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

namespace hilda::granular {

struct BedSphere {
    Vec3 r;         ///< centre [m]
    double radius;  ///< [m]
};

/// Spheres of one radius. The particles of a world have radii of single precision.
std::vector<BedSphere> equal_spheres(const std::vector<Vec3>& centres, double radius);
std::vector<BedSphere> equal_spheres(const World& world, double radius);

/// Height of the highest point of all spheres or particles [m]; -∞ if there are none
template <class Sphere>
double highest_point(const std::vector<Sphere>& spheres)
{
    double z = -std::numeric_limits<double>::infinity();
    for (const Sphere& s : spheres) z = std::max(z, s.r.z + s.radius);
    return z;
}

/// Height below which 98 % of the centres are [m]
double height_of_98_percent(const std::vector<BedSphere>& bed);

/// Mass of the spheres between 20 % and 80 % of a height over the volume there, `area` times the distance of
/// the two planes [kg/m³]. A plane cuts spheres. `density`: of the spheres.
double bulk_density(const std::vector<BedSphere>& bed, double height, double area, double density);

/// Height of the centre of a ball, or of the axis of a horizontal cylinder, when it touches the bed or the
/// floor from above [m]. `distance`: horizontal distance of a point from the centre or from the axis.
double first_contact(const std::vector<BedSphere>& bed, double radius,
                     const std::function<double(const Vec3&)>& distance);

}  // namespace hilda::granular
