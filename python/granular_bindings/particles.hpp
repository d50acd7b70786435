// SPDX-License-Identifier: GPL-3.0-or-later
/// Particles of a world as arrays.

#pragma once

#include "python/granular_bindings/world_object.hpp"

namespace hilda::python {

/// Adds the functions of particles to the class of worlds.
void define_particles(py::class_<WorldObject, WorldPointer>& world);

}  // namespace hilda::python
