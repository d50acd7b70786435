// SPDX-License-Identifier: GPL-3.0-or-later
/// Mass properties of the union of spheres, which may overlap.

#pragma once

#include "granular/core/surfaces/triangle_mesh.hpp"

#include <vector>

namespace hilda::granular {

struct Sphere {
    Vec3 r;         ///< centre [m]
    double radius;  ///< [m]
};

/// Volume, centre and inertia of the union of spheres of density 1: what is in several spheres counts once.
///
/// Spheres without overlaps have closed forms. Otherwise the union is cut into slices z = const, each a union
/// of discs. Area and moments of a slice are integrals along the arcs of its border (Green's theorem). The
/// integral over z is a Gauss-Legendre quadrature between the heights at which the border changes: the poles
/// of the spheres, the highest and lowest points of the circles in which two spheres intersect, and points
/// of three spheres. The relative error is below 1e-10.
MassProperties sphere_union(const std::vector<Sphere>& spheres);

}  // namespace hilda::granular
