// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact surfaces of imported collision geometries.

#pragma once

#include "contact/surface.hpp"
#include "io/json.hpp"
#include "run/importing/imported_model.hpp"

#include <exception>
#include <memory>
#include <string>

namespace hilda::run {

/// The surface of a shape, in the frame of the shape, and its keys in a model file without the pose. That of
/// points is their convex hull. Throws io::InvalidInput for sizes that are not positive and for points in a
/// plane.
std::shared_ptr<const contact::Surface> surface_of(const ImportedShape& shape, io::Json& keys);

/// The message of an error about a surface without the name of its class
std::string reason_of(const std::exception& error);

/// Raises a model of which each body can move freely, such that no shape is below the plane z = 0. Adds a
/// warning with the height.
void raise_above_floor(ImportedModel& model);

}  // namespace hilda::run
