// SPDX-License-Identifier: GPL-3.0-or-later
/// The keys of a case that are not lists of entries, and those of a material.

#pragma once

#include "granular/case/case_file.hpp"
#include "granular/reading/object_reader.hpp"

namespace hilda::granular {

/// Reads the name of a case, domain, gravity, times, skin, integrator and orientation. Throws
/// io::PlacedError.
void read_options(ObjectReader& o, Case& out, WorldOptions& world);

/// Reads an entry of `materials`. Throws io::PlacedError.
Material read_material(ObjectReader& o);

}  // namespace hilda::granular
