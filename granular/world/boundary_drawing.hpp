// SPDX-License-Identifier: GPL-3.0-or-later
/// Approximation of boundaries by polygons, for frames.

#pragma once

#include "granular/core/boundary.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

class World;

/// Polygons of a surface, in the global frame
struct Polygons {
    std::vector<Vec3> point;                ///< [m]
    std::vector<std::vector<int>> polygon;  ///< vertices, counterclockwise seen from the particles
};

/// The part of a boundary that is drawn, for a domain from `low` to `high`: of a plane its intersection with
/// the domain, of a cylinder or cone the part between the planes through the corners of the domain that are
/// perpendicular to its axis, a whole sphere. Empty if a plane does not intersect the domain.
Polygons drawing(const Boundary& boundary, const Vec3& low, const Vec3& high);

/// All boundaries of a world as a VTK file: cell data `boundary` (number), point data `velocity` [m/s]
std::string boundaries_vtp(const World& world);

}  // namespace hilda::granular
