// SPDX-License-Identifier: GPL-3.0-or-later
/// Boundaries and contacts of a world.

#pragma once

#include "python/granular_bindings/world_object.hpp"

namespace hilda::python {

/// Adds the functions of boundaries to the class of worlds.
void define_boundaries(py::class_<WorldObject, WorldPointer>& world);

}  // namespace hilda::python
