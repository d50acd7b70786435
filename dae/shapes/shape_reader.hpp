// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of the shape of a body in a model file.

#pragma once

#include "dae/body_shape.hpp"
#include "dae/object_reader.hpp"

namespace hilda::dae {

/// Reads the object "shape" of a body: one key with the name of the type, and "axis" for the types with an
/// axis. Throws PlacedError.
///
/// `gives_inertia`: the body is homogeneous. The centroid of a convex polyhedron must then be at the origin
/// of the body frame to within 1e-6 of its size; the message has the position that moves it there. The
/// canonical form of a polyhedron from a file has its vertices.
BodyShape read_shape(ObjectReader& body, bool gives_inertia);

}  // namespace hilda::dae
