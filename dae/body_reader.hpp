// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the mass properties and of the initial motion of a body in a model file.

#pragma once

#include "dae/body.hpp"
#include "dae/object_reader.hpp"

namespace hilda::dae {

/// Reads the keys mass, inertia, shape and density, and sets m, J_bar and shape of b. Without an inertia, or
/// with a density, the body is a homogeneous solid of the given shape. Throws io::PlacedError.
///
/// The canonical form has mass and inertia, and the shape if it is given. "density" must be removed from it.
void read_mass(ObjectReader& o, Body& b);

/// Reads the keys of the initial position, orientation and velocities. Throws io::PlacedError.
///
/// The canonical form has the orientation as A. The other forms must be removed from it.
Motion read_motion(ObjectReader& o);

}  // namespace hilda::dae
